// The plans of layouts day by day: what is frozen, which gaps are open, where the wall is weakest.
(function () {
  "use strict";
  const holder = document.getElementById("plan");
  const { layouts } = JSON.parse(document.getElementById("plan-data").textContent);
  const AT_ONCE = 2; // Layouts that are seen at first.
  const TURN = 250; // Time that a day is seen while they play (ms).
  const SPACE = "http://www.w3.org/2000/svg";

  const days = [...new Set(layouts.flatMap((layout) => layout.days.map((one) => one.day)))].sort((a, b) => a - b);
  if (!days.length) return;
  const reach = Math.max(...layouts.map((layout) => layout.reach_m));

  const make = (name, set, ...children) => {
    const element = Object.assign(document.createElement(name), set);
    element.append(...children);
    return element;
  };
  const draw = (name, attributes, ...children) => {
    const element = document.createElementNS(SPACE, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    element.append(...children);
    return element;
  };
  const number = (value, digits) => {
    const text = value.toFixed(digits);
    // What rounds to zero has no sign.
    return text.replace("-", Number(text) === 0 ? "" : "−");
  };

  /** The last day of a layout that is known by then; the first before. */
  const on = (layout, day) => layout.days.findLast((one) => one.day <= day) || layout.days[0];
  /** Whether symmetry makes all gaps of a layout equal: none is the weakest. */
  const areAlike = (layout) => layout.gaps.length > 0 && layout.gaps[0].alike + 1 === layout.gaps.length;
  const isOpen = (gap, day) => gap.closed_day === null || gap.closed_day > day;

  function said(layout, now) {
    const rows = [];
    const open = layout.gaps.filter((gap) => isOpen(gap, now.day)).length;
    const count = layout.gaps.length;
    const wall = now.closed ? "closed" : "open";
    rows.push(["Wall", count ? `${wall}, ${count - open} of ${count} gaps closed` : wall]);
    const gap = now.weakest === null ? null : layout.gaps[now.weakest];
    if (gap) {
      const thick = now.closed && now.thickness_m !== null ? `, ${number(now.thickness_m, 2)} m thick` : "";
      const cold = now.closed && now.mean_c !== null ? `, ${number(now.mean_c, 1)} °C in the mean` : "";
      const others = gap.alike ? ` and ${gap.alike} equal by symmetry` : "";
      const name = areAlike(layout) ? "all gaps are alike" : gap.name + others;
      rows.push([now.closed ? "Weakest gap" : "Widest open gap", `${name}${thick}${cold}`]);
    }
    if (now.load_w_per_m !== null) rows.push(["Load", `${number(now.load_w_per_m, 0)} W/m`]);
    return rows;
  }

  /** A plan whose drawing follows the day. */
  function card(layout) {
    const unit = layout.unit_m;
    const size = reach * 1.04;
    const line = (gap, set) => draw("line", { x1: gap.from[0], y1: gap.from[1], x2: gap.to[0], y2: gap.to[1], ...set });
    const svg = draw("svg", { viewBox: `${-size} ${-size} ${2 * size} ${2 * size}`, role: "img" });
    const upright = draw("g", { transform: "scale(1 -1)" });
    const ground = draw("path", { class: "ice", transform: `scale(${unit})`, "fill-rule": "evenodd" });
    upright.append(ground);
    if (layout.shaft_m !== null) upright.append(draw("circle", { class: "shaft", r: layout.shaft_m }));
    const gaps = layout.gaps.map((gap) => {
      const closes = gap.closed_day === null ? "does not close" : `closes on day ${number(gap.closed_day, 1)}`;
      const title = draw("title", {}, `${gap.name}, ${number(Math.hypot(gap.from[0] - gap.to[0], gap.from[1] - gap.to[1]), 2)} m: ${closes}`);
      return line(gap, {}).appendChild(title).parentNode;
    });
    upright.append(...gaps);
    for (const [x, y, r] of layout.pipes) upright.append(draw("circle", { class: "pipe", cx: x, cy: y, r: Math.max(r, 0.008 * reach) }));
    for (const [x, y] of layout.missing) {
      const arm = 0.02 * reach;
      upright.append(draw("path", { class: "lost", d: `M${x - arm} ${y - arm}l${2 * arm} ${2 * arm}m0 ${-2 * arm}l${-2 * arm} ${2 * arm}` }));
    }
    const label = draw("text", { "font-size": 0.07 * reach, "stroke-width": 0.02 * reach, "text-anchor": "middle", "dominant-baseline": "middle" });
    svg.append(upright, label);
    const facts = make("dl", {});
    const element = make("div", { className: "layout" }, make("p", { className: "name", textContent: layout.name }), svg, facts);

    function show(day) {
      const now = on(layout, day);
      const shown = areAlike(layout) ? null : now.weakest;
      ground.setAttribute("d", now.ground);
      gaps.forEach((element, k) => {
        const open = isOpen(layout.gaps[k], now.day) ? "open" : "closed";
        element.setAttribute("class", `gap ${open}${k === shown ? " weakest" : ""}`);
      });
      const weakest = shown === null ? null : layout.gaps[shown];
      label.textContent = weakest ? weakest.name : "";
      // Inside the ring, where there is room.
      if (weakest) {
        label.setAttribute("x", 0.35 * (weakest.from[0] + weakest.to[0]));
        label.setAttribute("y", -0.35 * (weakest.from[1] + weakest.to[1]));
      }
      const rows = said(layout, now);
      svg.setAttribute("aria-label", `${layout.name}, day ${number(now.day, 1)}: ${rows.map((row) => row.join(" ")).join(", ")}`);
      facts.replaceChildren(...rows.flatMap(([name, value]) => [make("dt", { textContent: name }), make("dd", { textContent: value })]));
    }
    return { element, show };
  }

  const cards = layouts.map(card);
  const chosen = new Set(layouts.slice(0, AT_ONCE).keys());
  const plans = make("div", { className: "plans" });
  const slider = make("input", { type: "range", min: 0, max: days.length - 1, step: 1, name: "day" });
  const told = make("output", {});
  const play = make("button", { type: "button", className: "play", textContent: "Play" });
  let timer = null;

  // The day on which the first wall stands says more than the last one.
  const first = days.findIndex((day) => layouts.some((layout, k) => chosen.has(k) && on(layout, day).closed));
  slider.value = first < 0 ? days.length - 1 : first;

  function show() {
    const day = days[slider.value];
    told.textContent = `day ${number(day, 1)}`;
    holder.dataset.day = String(day);
    for (const k of chosen) cards[k].show(day);
  }
  function choose() {
    plans.replaceChildren(...[...chosen].sort((a, b) => a - b).map((k) => cards[k].element));
    show();
  }
  function stop() {
    clearInterval(timer);
    timer = null;
    play.textContent = "Play";
  }
  slider.addEventListener("input", () => {
    stop();
    show();
  });
  play.addEventListener("click", () => {
    if (timer !== null) return stop();
    if (Number(slider.value) === days.length - 1) slider.value = 0;
    play.textContent = "Stop";
    timer = setInterval(() => {
      if (Number(slider.value) === days.length - 1) return stop();
      slider.value = Number(slider.value) + 1;
      show();
    }, TURN);
  });
  const boxes = layouts.map((layout, k) => {
    const box = make("input", { type: "checkbox", checked: chosen.has(k), name: "layout", value: k });
    box.addEventListener("change", () => {
      chosen[box.checked ? "add" : "delete"](k);
      choose();
    });
    return make("label", {}, box, ` ${layout.name}`);
  });
  const controls = make("div", { className: "controls" }, make("label", { className: "days" }, "Day ", slider), told, play);
  if (boxes.length > 1) controls.append(make("div", { className: "controls" }, ...boxes));
  holder.append(controls, plans, make("p", { className: "hint", textContent: "Shaded: frozen ground. Heavy line: the weakest gap of a closed wall, or the widest one that is open. Dashed: open gaps. Point at a gap for its day." }));
  holder.hidden = false;
  choose();
})();
