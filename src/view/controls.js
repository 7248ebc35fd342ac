  // What moves the camera: a part of the script of page.js, in its place there.

  // Movements wait for the next frame of the browser; those of one kind become one message.
  const movements = new Map();
  let isAwake = false;
  function move(kind, by, at) {
    const waiting = movements.get(kind);
    const sum = (a, b) => (Array.isArray(a) ? a.map((x, index) => x + b[index]) : a + b);
    movements.set(kind, { do: kind, ...(at && { at }), by: waiting ? sum(waiting.by, by) : by });
    wake();
  }
  function sendMovement() {
    const [kind] = movements.keys();
    // What a slow connection has not taken yet can still be merged.
    if (!kind || socket.bufferedAmount > 0) return;
    send(movements.get(kind));
    movements.delete(kind);
  }
  function wake() {
    if (!isAwake) requestAnimationFrame(tick);
    isAwake = true;
  }
  function tick(now) {
    isAwake = false;
    walk(now);
    sendMovement();
    draw();
    for (const arrived of untaken.splice(0)) send({ do: "taken", drawing: (performance.now() - arrived) / 1000 });
    if (movements.size > 0 || held.size > 0) wake();
  }

  // Pointers: a drag, a click, the divider, two fingers.
  const CLICK = 4;
  const pointers = new Map();
  let drag = null;
  const share = ({ x, y }) => [(x - place.left) / place.width, (y - place.top) / place.height];
  const onImage = (point) => share(point).map((x) => Math.min(Math.max(0, x), 1));
  const isInside = (point) => share(point).every((x) => x >= 0 && x < 1);
  const isWiped = () => isCompared() && magnification() === 0;
  const isOnDivider = ({ x }) => isWiped() && Math.abs(x - place.left - place.width * divider()) < 10;
  const middleOf = ([a, b]) => ({ x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 });
  const distanceOf = ([a, b]) => Math.max(1, Math.hypot(a.x - b.x, a.y - b.y));
  const spot = (event) => ({ x: event.clientX, y: event.clientY });
  function press(event) {
    const at = spot(event);
    image.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, at);
    if (pointers.size === 1) {
      const isLeft = event.button === 0;
      // With Ctrl some browsers of Macs tell of the other button.
      const isMain = isLeft || event.ctrlKey;
      const turns = event.ctrlKey || [...held].some((key) => key in WALKS) ? "turn" : "orbit";
      drag = { kind: isMain && !event.shiftKey ? turns : "pan", start: at, isClick: isLeft };
      if (isOnDivider(at)) drag = { kind: "divide" };
      else send({ do: "grab", at: onImage(at) });
    } else if (pointers.size === 2) {
      drag = { kind: "pinch" };
      send({ do: "grab", at: onImage(middleOf([...pointers.values()])) });
    }
  }
  function dragTo(event) {
    pointer = spot(event);
    image.style.cursor = pointers.size === 0 && isOnDivider(pointer) ? "ew-resize" : "";
    const before = pointers.get(event.pointerId);
    wake();
    if (!before || !drag) return;
    const both = [...pointers.values()];
    pointers.set(event.pointerId, pointer);
    if (drag.kind === "pinch") return pinch(both, [...pointers.values()]);
    if (drag.isClick && Math.hypot(pointer.x - drag.start.x, pointer.y - drag.start.y) < CLICK) return;
    // The movement below the limit counts too, once it is no click any more.
    const from = drag.isClick ? drag.start : before;
    drag.isClick = false;
    if (drag.kind === "divide") find("wipe").value = share(pointer)[0] * 100;
    else move(drag.kind, [(pointer.x - from.x) / place.height, (pointer.y - from.y) / place.height]);
  }
  function pinch(before, after) {
    const [from, to] = [middleOf(before), middleOf(after)];
    const notches = Math.log(distanceOf(after) / distanceOf(before)) / Math.log(1.2);
    move("pan", [(to.x - from.x) / place.height, (to.y - from.y) / place.height]);
    if (notches !== 0) move("zoom", notches, onImage(to));
  }
  function release(event) {
    pointers.delete(event.pointerId);
    if (event.type === "pointerup" && drag?.isClick && isInside(drag.start)) probeAt(share(drag.start));
    // A finger that stays after a pinch goes on to do nothing.
    drag = null;
  }
  function turnWheel(event) {
    event.preventDefault();
    const pixels = [1, 40, 400][event.deltaMode];
    // A pinch on a touch pad arrives as small turns of the wheel with Ctrl.
    move("zoom", (-event.deltaY * pixels) / (event.ctrlKey ? 20 : 100), onImage(spot(event)));
  }
  const probeAt = (at) => send({ do: "probe", at });

  // Keys.
  const WALKS = { a: [-1, 0, 0], d: [1, 0, 0], q: [0, -1, 0], e: [0, 1, 0], s: [0, 0, -1], w: [0, 0, 1] };
  const SIDES = { 1: "front", 2: "back", 3: "left", 4: "right", 5: "top", 6: "bottom", 7: "iso", f: "all", home: "start" };
  const ARROWS = { arrowleft: [-0.03, 0], arrowright: [0.03, 0], arrowup: [0, -0.03], arrowdown: [0, 0.03] };
  const MIDDLE = [0.5, 0.5];
  // Letters and digits by their place, whatever the layout has there; other keys, and digits with Shift, by what they say.
  const nameOf = ({ code, key, shiftKey }) => {
    const [, letter, digit] = /^Key(.)$|^Digit(.)$/.exec(code) ?? [];
    return (letter ?? (shiftKey ? key : (digit ?? key))).toLowerCase();
  };
  const held = new Set();
  const letGo = () => { held.clear(); wake(); };
  let walkedAt = 0;
  // About 30 messages a second, each with the time that it stands for.
  function walk(now) {
    const keys = [...held].filter((key) => key in WALKS);
    const passed = Math.min((now - walkedAt) / 1000, 0.1);
    if (keys.length === 0 || passed < 0.03) return;
    const by = [0, 1, 2].map((axis) => keys.reduce((sum, key) => sum + WALKS[key][axis] * passed, 0));
    if (by.some((x) => x !== 0)) move("walk", by);
    walkedAt = now;
  }
  function pressKey(event) {
    // The release of a key may not be told while one of these is held, which may also lead to another window or layout.
    if (event.metaKey || event.altKey) letGo();
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.closest("select, [type=range], [type=number], dialog")) return;
    const key = nameOf(event);
    if (event.key === "?") find("help").showModal();
    else if (key in WALKS || key === "z") {
      if (held.size === 0) walkedAt = performance.now();
      held.add(key);
      wake();
    } else if (key in SIDES) send({ do: "side", side: SIDES[key] });
    else if (event.target === image) pressImageKey(key, event);
  }
  // What the pointer does, for those who have none: at the middle of the image.
  function pressImageKey(key, { repeat, shiftKey }) {
    if (key in ARROWS) {
      if (!repeat) send({ do: "grab", at: MIDDLE });
      move(shiftKey ? "pan" : "orbit", ARROWS[key]);
    } else if (key === "+") move("zoom", 1, MIDDLE);
    else if (key === "-") move("zoom", -1, MIDDLE);
    else if (key === "enter") probeAt(MIDDLE);
  }

  image.addEventListener("pointerdown", press);
  image.addEventListener("pointermove", dragTo);
  image.addEventListener("pointerup", release);
  image.addEventListener("pointercancel", release);
  image.addEventListener("pointerleave", () => { pointer = null; wake(); });
  image.addEventListener("contextmenu", (event) => event.preventDefault());
  image.addEventListener("wheel", turnWheel, { passive: false });
  addEventListener("keydown", pressKey);
  addEventListener("keyup", (event) => { held.delete(nameOf(event)); wake(); });
  addEventListener("blur", letGo);
  document.addEventListener("visibilitychange", letGo);
