  // What the panels show and change: a part of the script of page.js, in its place there.

  // What is shown of the file.
  const settings = find("settings").elements;
  const SIZES = [[1280, 720], [1920, 1080], [3840, 2160]];
  let wanted = {};
  function showSettings() {
    wanted = { ...state.shown };
    const { shown, own_size: own, looks, transfers, ups } = state;
    const inWindow = freeRoom().map((length) => Math.max(1, Math.round(length * devicePixelRatio)));
    const sizes = new Map([...SIZES.map((size) => [size, ""]), [shown.size, ""], [inWindow, ", as this window"], [own, ", as given"]]
      .map(([size, words]) => [size.join("x"), size.join(" × ") + words]));
    const named = (names) => names.map((name) => [name, name]);
    fill(settings.size, [...sizes], shown.size.join("x"));
    fill(settings.look, [["", "as rendered"], ...named(looks)], shown.look ?? "");
    fill(settings.transfer, [["", "of the file"], ...named(transfers)], shown.transfer ?? "");
    fill(settings.up, [["", "as usual"], ...named(ups)], shown.up ?? "");
    settings.stays.value = shown.stays ? "stay" : "";
    if (document.activeElement !== settings.exposure) settings.exposure.value = shown.exposure;
    settings.stays.parentElement.hidden = !state.follows;
    settings.up.parentElement.hidden = ups.length === 0;
  }
  const READ = { size: (text) => text.split("x").map(Number), stays: (text) => text !== "", exposure: (text) => Math.max(-64, Math.min(64, Number(text))) };
  find("settings").addEventListener("change", ({ target: { name, value } }) => {
    // Of changes that the server has not answered yet none is lost.
    wanted[name] = (READ[name] ?? ((text) => text || null))(value);
    send({ do: "show", ...wanted });
  });

  // What accuracy costs: the settings of the halves.
  const SIDE_CHOICES = [1, 2, 3, 4, 5, 6, 8, 12, 16];
  function fill(select, choices, chosen) {
    const wanted = JSON.stringify(choices);
    if (select.dataset.choices !== wanted) {
      select.dataset.choices = wanted;
      select.replaceChildren(...choices.map(([value, text]) => make("option", { value, textContent: text })));
    }
    select.value = chosen;
  }
  const fieldsets = NAMES.map((_, index) => {
    const fields = find("half").content.firstElementChild.cloneNode(true);
    find("halves").append(fields);
    fields.addEventListener("change", ({ target: { name, value } }) => {
      const changed = state.halves.map((half) => ({ ...half }));
      changed[index][name] = name === "side" ? Number(value) : value || null;
      // A number of samples is one of a sampler.
      if (name === "side") changed[index].sampler ??= "sobol";
      send({ do: "set", halves: changed });
    });
    return fields;
  });
  function showHalves() {
    const compared = isCompared();
    fieldsets.forEach((fields, index) => {
      const half = state.halves[index];
      fields.hidden = !half;
      fields.querySelector("legend").textContent = compared ? ["A, to the left", "B, to the right"][index] : "Setting";
      if (half) showSetting(fields, half);
    });
    find("compare").setAttribute("aria-pressed", compared);
    find("compare").disabled = state.shown.look !== null;
    for (const id of ["compared", "difference", "labels"]) find(id).hidden = !compared;
  }
  function showSetting(fields, half) {
    const { sampler, side, precision, tracer } = fields.elements;
    const sides = [...new Set([...SIDE_CHOICES, half.side])].sort((a, b) => a - b);
    fill(sampler, [["", "as in the file"], ...state.samplers.map((name) => [name, name])], half.sampler ?? "");
    fill(side, sides.map((n) => [String(n), String(n * n)]), String(half.side));
    precision.value = half.precision;
    tracer.value = half.tracer;
  }
  // B begins as A in the other arithmetic, so that a leak of it is seen at once.
  function compare() {
    const [a] = state.halves;
    const b = { ...a, precision: a.precision === "exact" ? "fast" : "exact" };
    find("shown").value = "0";
    send({ do: "set", halves: isCompared() ? [a] : [a, b] });
  }
  // In the panel a narrow chart if there is one; the wide one in a dialog.
  show.chart = ({ wide, narrow: small }) => {
    find("chart").innerHTML = small;
    find("large-chart").innerHTML = wide;
    find("enlarge").hidden = false;
  };

  // Figures, a column for each half.
  function showTable(id, columns, rows) {
    const cell = (tag, scope) => (textContent) => make(tag, { textContent, ...(scope && { scope }) });
    const head = columns > 1 ? [make("tr", {}, ...["", ...NAMES].map(cell("th", "col")))] : [];
    const body = rows.map(([name, values]) => make("tr", {}, cell("th", "row")(name), ...values.map(cell("td"))));
    find(id).replaceChildren(make("thead", {}, ...head), make("tbody", {}, ...body));
  }
  // What was counted at all, with the names of its groups before its own.
  const counted = (groups, before = "") => Object.assign({}, ...Object.entries(groups).map(([name, value]) =>
    (plain(value) ? (value > 0 ? { [`${before}${name}`]: value } : {}) : counted(value, `${before}${name}: `))));
  const errorOf = ({ error }) => (error === null ? "not known" : brief(error));
  const speedOf = (half) => compact.format(half.rays_per_second);
  show.figures = ({ halves: shown }) => {
    const counts = shown.map((half) => counted(half.counters));
    const names = [...new Set(counts.flatMap(Object.keys))];
    showTable("figures", shown.length, [
      ["Samples", shown.map((half) => half.samples)],
      ["Time", shown.map((half) => duration(half.seconds))],
      ["Error", shown.map(errorOf)],
      ["Rays", shown.map((half) => grouped(half.rays))],
      ["Rays a second", shown.map(speedOf)],
    ]);
    showTable("counters", shown.length, names.map((name) => [name, counts.map((count) => brief(count[name] ?? 0))]));
    showStatus(shown);
    showLabels(shown);
    showShares(shown);
  };
  function doing(half) {
    if (half.moving) return "moving";
    if (half.rests) return "at rest: the whole image";
    return `refining: ${Math.floor(half.done * 100)} % of ${half.next}`;
  }
  function showStatus(shown) {
    const [a, b = isCompared() ? "to come" : a] = shown.map(doing);
    const rests = shown.length === state?.halves.length && shown.every((half) => half.rests);
    write("status", a === b ? a : `A: ${a}; B: ${b}`);
    // Spoken only when it is another word, not with each ray.
    write("announced", rests ? "The image is done" : shown.some((half) => half.moving) ? "Moving" : "Refining");
  }
  function showLabels(shown) {
    shown.forEach((half, index) => {
      const lines = [duration(half.seconds), `error ${errorOf(half)}`, `${speedOf(half)} rays a second`];
      find(`label-${index}`).replaceChildren(make("b", { textContent: NAMES[index] }), lines.join("\n"));
    });
  }
  function showShares(shown) {
    find("shares").replaceChildren(...shown.flatMap((half, index) => {
      const heading = shown.length === 2 ? [make("h3", { textContent: NAMES[index] })] : [];
      return [...heading, ...half.passes.map(makeShare)];
    }));
  }
  function makeShare([name, part], index) {
    const bar = make("div");
    bar.style.width = `${part * 100}%`;
    bar.style.background = `var(--s${index % 7})`;
    const words = [name, `${(part * 100).toFixed(1)} %`].map((textContent) => make("span", { textContent }));
    return make("div", { className: "share" }, words[0], make("div", {}, bar), words[1]);
  }

  // What is simulated.
  show.plan = ({ effects, passes, bvh }) => {
    // What could not be prepared before is now.
    find("error").hidden = true;
    const words = (tag, textContent) => make(tag, { textContent });
    const item = ({ name, effect = name, reason, present }) =>
      make("div", { className: present ? "" : "absent" }, words("dt", effect.replaceAll("-", " ")), words("dd", reason));
    const ordered = [...effects].sort((a, b) => b.present - a.present);
    find("effects").replaceChildren(...ordered.map(item));
    find("passes").replaceChildren(...passes.filter((pass) => !pass.runs).map(item));
    write("bvh", `Tree of boxes: ${bvh}`);
  };

  // A pixel, in the words of `wavecrest probe`; its cross goes when they are closed.
  let probed = null;
  show.probe = ({ at, record }) => {
    probed = at;
    write("record", record);
    write("pixel-note", "The cross marks the pixel in the image.");
    find("pixel").open = true;
    find("pixel").scrollIntoView();
    wake();
  };
  function forgetProbe() {
    if (probed) write("pixel-note", "The camera has moved since: click again.");
    probed = null;
  }
  find("pixel").addEventListener("toggle", ({ target }) => {
    if (!target.open) probed = null;
    wake();
  });

  // Take away.
  async function copyCommand({ target: button }) {
    const command = find(button.dataset.copies);
    let copied = true;
    try {
      await navigator.clipboard.writeText(command.textContent);
    } catch {
      // Only pages of this machine have a clipboard, and not those of every browser.
      getSelection().selectAllChildren(command);
      copied = document.execCommand("copy");
    }
    button.textContent = copied ? "Copied" : "Selected";
    setTimeout(() => { button.textContent = "Copy"; }, 1500);
  }
