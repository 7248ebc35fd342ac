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
