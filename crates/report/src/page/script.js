"use strict";
(() => {
  const make = (tag, properties) => Object.assign(document.createElement(tag), properties);

  // Light or dark, against what the system prefers; kept where the browser keeps anything.
  const root = document.documentElement;
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const isDark = () => (root.dataset.theme ? root.dataset.theme === "dark" : dark.matches);
  const kept = (write) => { try { return write(localStorage); } catch { return null; } };
  const theme = kept((store) => store.getItem("wavecrest-theme"));
  if (theme === "light" || theme === "dark") root.dataset.theme = theme;
  const toggle = make("button", { type: "button", className: "theme" });
  const name = () => { toggle.textContent = isDark() ? "Light" : "Dark"; };
  toggle.setAttribute("aria-label", "Switch between light and dark");
  toggle.addEventListener("click", () => {
    root.dataset.theme = isDark() ? "light" : "dark";
    kept((store) => store.setItem("wavecrest-theme", root.dataset.theme));
    name();
  });
  dark.addEventListener("change", name);
  name();
  document.querySelector("header").append(toggle);

  // Values at the points of charts, under the pointer and the keyboard.
  const tip = make("div", { className: "tip", hidden: true });
  tip.setAttribute("role", "tooltip");
  document.body.append(tip);
  const hide = () => { tip.hidden = true; };
  const show = (mark) => {
    tip.textContent = mark.dataset.values;
    tip.hidden = false;
    const at = mark.getBoundingClientRect();
    const { offsetWidth: width, offsetHeight: height } = tip;
    const left = Math.min(Math.max(8, at.left + at.width / 2 - width / 2), root.clientWidth - width - 8);
    const above = at.top - height - 8;
    tip.style.left = `${Math.max(8, left)}px`;
    tip.style.top = `${above > 8 ? above : at.bottom + 8}px`;
  };
  for (const chart of document.querySelectorAll("svg.chart")) {
    const marks = [...chart.querySelectorAll(".mark")];
    const go = (from, to) => {
      if (!marks[to] || to === from) return;
      marks[from].setAttribute("tabindex", "-1");
      marks[to].setAttribute("tabindex", "0");
      marks[to].focus();
    };
    marks.forEach((mark, index) => {
      // The browser's own tip would come on top of this one.
      const title = mark.querySelector("title");
      mark.dataset.values = title.textContent;
      mark.setAttribute("aria-label", title.textContent);
      title.remove();
      // One stop for each chart; arrows lead from point to point.
      mark.setAttribute("tabindex", index === 0 ? "0" : "-1");
      mark.addEventListener("pointerenter", () => show(mark));
      mark.addEventListener("pointerleave", hide);
      mark.addEventListener("focus", () => show(mark));
      mark.addEventListener("blur", hide);
      mark.addEventListener("keydown", (event) => {
        const next = { ArrowRight: index + 1, ArrowDown: index + 1, ArrowLeft: index - 1, ArrowUp: index - 1, Home: 0, End: marks.length - 1 }[event.key];
        if (event.key === "Escape") hide();
        if (next === undefined) return;
        event.preventDefault();
        go(index, next);
      });
    });
  }
  addEventListener("scroll", hide, { passive: true });

  // Two pictures under a divide that moves.
  for (const pair of document.querySelectorAll(".pair")) {
    const [left, right] = [...pair.querySelectorAll("p")].map((side) => side.textContent);
    const slider = make("input", { type: "range", className: "divide", min: 0, max: 100, step: 0.1, value: 50 });
    slider.setAttribute("aria-label", `Divide between ${left} and ${right}`);
    const move = (share) => {
      pair.style.setProperty("--divide", `${share}%`);
      slider.setAttribute("aria-valuetext", `${Math.round(share)}% ${left}`);
    };
    slider.addEventListener("input", () => move(slider.value));
    const follow = (event) => {
      const { left: start, width } = pair.getBoundingClientRect();
      slider.value = (100 * (event.clientX - start)) / width;
      move(slider.value);
    };
    pair.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      pair.setPointerCapture(event.pointerId);
      follow(event);
    });
    pair.addEventListener("pointermove", (event) => { if (pair.hasPointerCapture(event.pointerId)) follow(event); });
    pair.addEventListener("dragstart", (event) => event.preventDefault());
    pair.classList.add("joined");
    pair.after(slider);
    move(50);
    // The whole of one, then the whole of the other: what differs flickers.
    let timer = null;
    const flicker = make("button", { type: "button", className: "flicker", textContent: "Flicker" });
    flicker.setAttribute("aria-pressed", "false");
    flicker.addEventListener("click", () => {
      clearInterval(timer);
      const turn = () => { slider.value = Number(slider.value) < 50 ? 100 : 0; move(slider.value); };
      timer = timer === null ? setInterval(turn, 400) : null;
      if (timer !== null) turn();
      flicker.setAttribute("aria-pressed", String(timer !== null));
      flicker.textContent = timer === null ? "Flicker" : "Stop";
    });
    slider.after(flicker);
  }

  // Pictures of pixels in a row are seen from near all at once, at the place that was pressed.
  for (const row of document.querySelectorAll(".pictures:has(img.pixels)")) {
    row.classList.add("zooms");
    const zoom = (x, y) => {
      row.style.setProperty("--x", `${x}%`);
      row.style.setProperty("--y", `${y}%`);
      row.classList.toggle("near");
    };
    for (const image of row.querySelectorAll("img.pixels")) {
      const frame = image.parentElement;
      frame.tabIndex = 0;
      frame.setAttribute("role", "button");
      frame.setAttribute("aria-label", `${image.alt}: zoom`);
      frame.addEventListener("click", (event) => {
        const { left, top, width, height } = frame.getBoundingClientRect();
        zoom((100 * (event.clientX - left)) / width, (100 * (event.clientY - top)) / height);
      });
      frame.addEventListener("keydown", (event) => {
        if (event.key === "Enter") zoom(50, 50);
        const step = { ArrowLeft: [-10, 0], ArrowRight: [10, 0], ArrowUp: [0, -10], ArrowDown: [0, 10] }[event.key];
        if (!step || !row.classList.contains("near")) return;
        event.preventDefault();
        ["--x", "--y"].forEach((name, axis) => {
          const at = parseFloat(row.style.getPropertyValue(name)) + step[axis];
          row.style.setProperty(name, `${Math.min(100, Math.max(0, at))}%`);
        });
      });
    }
  }

  // Rows in the order of a column.
  for (const table of document.querySelectorAll("table")) {
    const body = table.tBodies[0];
    const heads = [...table.tHead.rows[0].cells];
    if (body.rows.length < 3) continue;
    heads.forEach((head, index) => {
      const button = make("button", { type: "button" });
      button.append(...head.childNodes);
      head.append(button);
      const key = (row) => {
        const cell = row.cells[index];
        return cell.dataset.value === undefined ? cell.textContent : Number(cell.dataset.value);
      };
      const order = (a, b) => {
        const [x, y] = [key(a), key(b)];
        if (typeof x !== typeof y) return typeof x === "number" ? -1 : 1;
        return typeof x === "number" ? x - y : x.localeCompare(y, "en", { numeric: true });
      };
      button.addEventListener("click", () => {
        const up = head.getAttribute("aria-sort") !== "ascending";
        heads.forEach((other) => other.removeAttribute("aria-sort"));
        head.setAttribute("aria-sort", up ? "ascending" : "descending");
        const rows = [...body.rows].sort(order);
        body.append(...(up ? rows : rows.reverse()));
      });
    });
  }
})();
