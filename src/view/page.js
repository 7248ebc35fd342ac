"use strict";
(() => {
  const find = (id) => document.getElementById(id);
  const make = (tag, properties = {}, ...children) => {
    const element = Object.assign(document.createElement(tag), properties);
    element.append(...children);
    return element;
  };
  const write = (id, text) => { if (find(id).textContent !== text) find(id).textContent = text; };
  const plain = (value) => value === null || typeof value !== "object";
  const NAMES = ["A", "B"];
  const image = find("image");
  const narrow = matchMedia("(max-width: 45rem)");
  let state = null;

  // Numbers in words.
  const grouped = (n) => n.toLocaleString("en", { maximumFractionDigits: 9 }).replaceAll(",", "\u202f");
  const compact = new Intl.NumberFormat("en", { notation: "compact", compactDisplay: "long", maximumSignificantDigits: 3 });
  function brief(x) {
    if (Number.isInteger(x)) return grouped(x);
    if (x >= 1e-3) return grouped(Number(x.toPrecision(3)));
    const raised = (digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[digit];
    return x.toExponential(2).replace(/e-(\d+)/, (_, power) => ` × 10⁻${[...power].map(raised).join("")}`);
  }
  function duration(seconds) {
    if (seconds < 1) return `${brief(seconds * 1000)} ms`;
    if (seconds < 120) return `${seconds.toFixed(seconds < 10 ? 2 : 1)} s`;
    return `${Math.floor(seconds / 60)} min ${Math.round(seconds % 60)} s`;
  }

  // The connection.
  let socket = null;
  const send = (message) => { if (socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message)); };
  const MOST_FAILURES = 10;
  let failures = 0;
  function connect() {
    socket = new WebSocket(new URL("socket", location.href.replace(/^http/, "ws")));
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({ data }) => {
      find("ended").hidden = true;
      failures = 0;
      if (typeof data === "string") receive(JSON.parse(data));
      else receivePart(data);
    };
    // With a reason there are too many pages; there may be fewer when it is tried again.
    socket.onclose = ({ reason }) => {
      write("ended-why", reason || "The server has ended.");
      find("ended").hidden = false;
      find("stage").hidden = true;
      failures += 1;
      // Somebody else may listen at the port of a server that has ended.
      if (reason || failures < MOST_FAILURES) setTimeout(connect, 1000);
    };
  }
  // What to do with a message of each kind.
  const show = {};
  const receive = (message) => show[message.kind]?.(message);
  show.progress = ({ stage, done, all }) => {
    find("stage").hidden = false;
    write("stage-name", stage);
    const bar = find("stage-done");
    if (all > 0) Object.assign(bar, { max: all, value: done });
    else bar.removeAttribute("value");
  };
  show.error = ({ message }) => {
    write("error", message);
    find("error").hidden = false;
    find("stage").hidden = true;
  };
  show.state = (message) => {
    const isNew = (key) => JSON.stringify(message[key]) !== JSON.stringify(state?.[key]);
    const [isMoved, isShownOtherwise] = [isNew("camera"), isNew("shown")];
    state = message;
    if (isMoved || isShownOtherwise) {
      forgetProbe();
      halves[1] = newHalf();
      for (const id of ["chart", "large-chart"]) find(id).replaceChildren();
    }
    if (isShownOtherwise) layOut();
    document.title = `${state.file} – wavecrest view`;
    write("file", state.file);
    ["render", "convert"].forEach((id, index) => {
      find(id).replaceChildren(...state.commands[index].split(/(?<= )/).map((textContent) => make("span", { textContent })));
    });
    find("picture").download = state.image;
    showSettings();
    showHalves();
    wake();
  };

  // The frames of both halves, each in a canvas of its own size, and the difference. What came as a JPEG has no pixels
  // that are known.
  const newHalf = () => ({ canvas: make("canvas"), pixels: null, isShown: false, moving: false });
  const halves = [newHalf(), newHalf()];
  const difference = newHalf();
  function put(half, drawn) {
    const isExact = drawn instanceof ImageData;
    const { width, height } = drawn;
    Object.assign(half, { pixels: isExact ? drawn : null, isShown: true });
    Object.assign(half.canvas, { width, height });
    const context = half.canvas.getContext("2d");
    if (isExact) context.putImageData(drawn, 0, 0);
    else context.drawImage(drawn, 0, 0);
  }
  // A frame comes in one part, or on a slow line in several. Each is answered: the last once it is drawn, with the time
  // that this took, from which the server learns what the line passes.
  const HEAD = 24;
  const untaken = [];
  let frame = null;
  let shownFrames = Promise.resolve();
  function receivePart(buffer) {
    const arrived = performance.now();
    const head = new DataView(buffer);
    const [index, width, height, flags, length, from] = [0, 4, 8, 12, 16, 20].map((at) => head.getUint32(at, true));
    const part = new Uint8ClampedArray(buffer, HEAD);
    if (from === 0) frame = { half: halves[index], bytes: part.length === length ? part : new Uint8ClampedArray(length) };
    if (part.length !== length) frame.bytes.set(part, from);
    if (from + part.length < length) return send({ do: "taken" });
    const { half, bytes } = frame;
    // One after the other: a JPEG takes a while.
    shownFrames = shownFrames.then(() => showFrame(half, bytes, width, height, flags)).catch(() => {}).then(() => {
      untaken.push(arrived);
      wake();
    });
  }
  async function showFrame(half, bytes, width, height, flags) {
    if ((flags & 4) !== 0) put(half, await createImageBitmap(new Blob([bytes], { type: "image/jpeg" })));
    else {
      const pixels = new ImageData(bytes, width, height);
      if ((flags & 2) !== 0 || !half.isShown) put(half, pixels);
      else layOver(half, pixels);
    }
    half.moving = (flags & 1) === 1;
    find("stage").hidden = true;
    if (isCompared()) subtract();
  }
  // What is not finished in a frame shows the image before. Canvases are never read: browsers that guard against being
  // recognised answer with noise, or ask first.
  function layOver(half, frame) {
    const { width, height } = frame;
    const [canvas, top] = [0, 1].map(() => make("canvas", { width, height }));
    top.getContext("2d").putImageData(frame, 0, 0);
    const context = canvas.getContext("2d");
    for (const layer of [half.canvas, top]) context.drawImage(layer, 0, 0, width, height);
    half.canvas = canvas;
    // The same for the numbers of pixels, which are not smoothed, unless a JPEG is below.
    if (!half.pixels) return;
    const [before, now] = [half.pixels, frame].map(({ data }) => new Uint32Array(data.buffer, data.byteOffset, data.length / 4));
    for (let at = 0, y = 0; y < height; y += 1) {
      const row = Math.floor((y * half.pixels.height) / height) * half.pixels.width;
      for (let x = 0; x < width; x += 1, at += 1) {
        if (now[at] === 0) now[at] = before[row + Math.floor((x * half.pixels.width) / width)];
      }
    }
    half.pixels = frame;
  }
  const isCompared = () => state?.halves.length === 2;
  const magnification = () => (isCompared() ? Number(find("shown").value) : 0);

  // |A - B|, magnified; there is none while the halves have different sizes.
  function subtract() {
    const [a, b] = halves.map((half) => half.pixels);
    Object.assign(difference, { pixels: null, isShown: false });
    write("difference", "");
    if (!a || !b || a.width !== b.width || a.height !== b.height) return;
    const by = magnification();
    const pixels = new ImageData(a.width, a.height);
    const [from, less, result] = [a.data, b.data, pixels.data];
    let [different, greatest] = [0, 0];
    for (let at = 0; at < from.length; at += 4) {
      let largest = 0;
      for (let channel = at; channel < at + 3; channel += 1) {
        const distance = Math.abs(from[channel] - less[channel]);
        result[channel] = distance * by;
        if (distance > largest) largest = distance;
      }
      result[at + 3] = 255;
      if (largest > 0) different += 1;
      if (largest > greatest) greatest = largest;
    }
    put(difference, pixels);
    if (halves.some((half) => half.moving)) return;
    const all = grouped(a.width * a.height);
    write("difference", different === 0 ? `A and B agree in all ${all} pixels.`
      : `Pixels that differ: ${grouped(different)} of ${all}. Greatest difference of a channel: ${greatest} of 255.`);
  }

  // Where the image lies in the window: in the room beside the panels.
  let place = { left: 0, top: 0, width: 1, height: 1 };
  function freeRoom() {
    const { left, top } = find("panels").getBoundingClientRect();
    if (narrow.matches) return [innerWidth, top];
    return [find("sheets").hidden ? innerWidth : left, innerHeight];
  }
  function layOut() {
    const ratio = devicePixelRatio;
    const room = freeRoom();
    const size = state?.shown.size ?? [3, 2];
    let scale = Math.min(...room.map((length, axis) => (length * ratio) / size[axis]));
    // A little smaller than the room, but each pixel as large as the others.
    if (scale > 1 && scale % 1 < 0.15 * scale) scale = Math.floor(scale);
    const [width, height] = size.map((length) => Math.round(length * scale) / ratio);
    const margin = (length, axis) => Math.max(0, Math.round(((room[axis] - length) / 2) * ratio) / ratio);
    const [left, top] = [width, height].map(margin);
    place = { left, top, width, height };
    placeLabels(room);
    [image.width, image.height] = [innerWidth, innerHeight].map((length) => Math.round(length * ratio));
    draw();
  }
  // The ratio changes without the window's size when that moves to another screen.
  function followRatio() {
    layOut();
    matchMedia(`(resolution: ${devicePixelRatio}dppx)`).addEventListener("change", followRatio, { once: true });
  }
  // At the lower edge of the image; on narrow windows below it, as far as there is room.
  function placeLabels(room) {
    const { style } = find("labels");
    style.left = `${place.left}px`;
    style.width = `${Math.min(place.width, room[0] - place.left)}px`;
    style.bottom = `${innerHeight - Math.min(place.top + place.height + (narrow.matches ? 80 : 0), room[1])}px`;
  }
  const divider = () => Number(find("wipe").value) / 100;

  // Drawing, at most once per frame of the browser.
  function draw() {
    const context = image.getContext("2d");
    context.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
    context.clearRect(0, 0, innerWidth, innerHeight);
    if (magnification() > 0) drawPart(context, difference, 0, 1);
    else if (isCompared()) drawWipe(context);
    else drawPart(context, halves[0], 0, 1);
    if (probed) {
      const [x, y] = [place.left + probed[0] * place.width, place.top + probed[1] * place.height];
      drawLines(context, new Path2D(`M${x - 9} ${y}h6m6 0h6M${x} ${y - 9}v6m0 6v6`));
    }
    drawLoupe();
  }
  function drawWipe(context) {
    drawPart(context, halves[0], 0, divider());
    // Until B is rendered, A is all there is.
    drawPart(context, halves[halves[1].isShown ? 1 : 0], divider(), 1);
    const [x, middle] = [place.left + place.width * divider(), place.top + place.height / 2];
    drawLines(context, new Path2D(`M${x} ${place.top}v${place.height}M${x - 6} ${middle - 6}l-6 6l6 6m12 -12l6 6l-6 6`));
  }
  function drawPart(context, { canvas, isShown, moving }, from, to) {
    if (!isShown) return;
    context.save();
    context.beginPath();
    context.rect(place.left + from * place.width, place.top, (to - from) * place.width, place.height);
    context.clip();
    context.imageSmoothingEnabled = moving || canvas.width > place.width * devicePixelRatio;
    context.imageSmoothingQuality = "high";
    context.drawImage(canvas, place.left, place.top, place.width, place.height);
    context.restore();
  }
  // White within black, to be seen on every image.
  function drawLines(context, path) {
    for (const [lineWidth, strokeStyle] of [[3.5, "#000"], [1.5, "#fff"]]) {
      Object.assign(context, { lineWidth, strokeStyle, lineCap: "square" });
      context.stroke(path);
    }
  }

  // The loupe: 11 by 11 pixels around the pointer, 12 times as large, of each half or of the difference.
  const REACH = 5;
  const ENLARGED = 12;
  let pointer = null;
  function drawLoupe() {
    const loupe = find("loupe");
    const isOn = find("magnify").checked || held.has("z");
    const both = isCompared() ? [["A", halves[0]], ["B", halves[1]]] : [["Colour", halves[0]]];
    const shown = magnification() > 0 ? [["Difference", difference]] : both;
    image.classList.toggle("magnified", isOn);
    loupe.hidden = !isOn || !pointer || !isInside(pointer) || shown.some(([, half]) => !half.pixels);
    if (loupe.hidden) return;
    loupe.replaceChildren(...shown.map(([name, half]) => makeEnlarged(name, half, share(pointer))));
    // Beside the pointer, so that it does not hide what it enlarges.
    const beside = (at, size, all) => Math.max(0, at + 24 + size < all ? at + 24 : at - 24 - size);
    loupe.style.left = `${beside(pointer.x, loupe.offsetWidth, innerWidth)}px`;
    loupe.style.top = `${beside(pointer.y, loupe.offsetHeight, innerHeight)}px`;
  }
  function makeEnlarged(name, { canvas: source, pixels }, at) {
    const size = 2 * REACH + 1;
    const canvas = make("canvas", { width: ENLARGED * size, height: ENLARGED * size });
    const context = canvas.getContext("2d");
    const [x, y] = [Math.floor(at[0] * source.width), Math.floor(at[1] * source.height)];
    const from = 4 * (y * source.width + x);
    context.imageSmoothingEnabled = false;
    context.drawImage(source, x - REACH, y - REACH, size, size, 0, 0, canvas.width, canvas.height);
    const middle = REACH * ENLARGED;
    drawLines(context, new Path2D(`M${middle} ${middle}h${ENLARGED}v${ENLARGED}h-${ENLARGED}z`));
    const colour = pixels.data.slice(from, from + 3).join(" ");
    return make("figure", {}, canvas, make("figcaption", { textContent: `${name}: ${colour}` }));
  }

  // {{controls}}

  // {{panels}}

  // Light or dark, against what the system prefers; kept where the browser keeps anything.
  const { dataset } = document.documentElement;
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const kept = (use) => { try { return use(localStorage); } catch { return null; } };
  const isDark = () => (dataset.theme ? dataset.theme === "dark" : dark.matches);
  const nameTheme = () => write("theme", isDark() ? "Light" : "Dark");
  function switchTheme() {
    dataset.theme = isDark() ? "light" : "dark";
    kept((store) => store.setItem("wavecrest-theme", dataset.theme));
    nameTheme();
  }
  const theme = kept((store) => store.getItem("wavecrest-theme"));
  if (theme === "light" || theme === "dark") dataset.theme = theme;
  dark.addEventListener("change", nameTheme);
  nameTheme();

  function fold() {
    const isHidden = find("sheets").toggleAttribute("hidden");
    find("fold").setAttribute("aria-expanded", !isHidden);
    write("fold", isHidden ? "Show" : "Hide");
  }
  const on = (id, type, action) => find(id).addEventListener(type, action);
  addEventListener("resize", layOut);
  new ResizeObserver(layOut).observe(find("panels"));
  on("theme", "click", switchTheme);
  on("help-button", "click", () => find("help").showModal());
  on("fold", "click", fold);
  on("first", "click", () => send({ do: "side", side: "start" }));
  on("all", "click", () => send({ do: "side", side: "all" }));
  on("compare", "click", compare);
  on("enlarge", "click", () => find("large").showModal());
  on("reload", "click", () => location.reload());
  on("magnify", "change", wake);
  on("wipe", "input", wake);
  on("shown", "change", () => { subtract(); wake(); });
  for (const button of document.querySelectorAll("[data-copies]")) button.addEventListener("click", copyCommand);
  for (const dialog of document.querySelectorAll("dialog")) dialog.querySelector("button").addEventListener("click", () => dialog.close());
  fill(find("shown"), [["0", "A and B"], ...[1, 4, 16, 64, 256].map((by) => [String(by), `Difference × ${by}`])], "0");
  followRatio();
  connect();
})();
