// Errors against costs. The library draws axes and looks after zoom and the legend; curves, markers and bars are drawn here.
(function () {
  "use strict";
  const holder = document.getElementById("chart");
  const { scenes } = JSON.parse(document.getElementById("chart-data").textContent);
  const chosen = { scene: 0, measure: 0, cost: 0, hidden: new Set() };
  const REACH = 28; // How far the pointer may be from a point that it names (px).
  let plot = null;

  const make = (name, set, ...children) => {
    const element = Object.assign(document.createElement(name), set);
    element.append(...children);
    return element;
  };
  const colourOf = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

  /** Three digits, with a unit that suits the size. */
  function digits(value) {
    if (value === 0) return "0";
    const decade = Math.floor(Math.log10(Math.abs(value)));
    if (decade < -4 || decade > 6) {
      const raised = [...String(decade)].map((sign) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(sign)]).join("");
      return `${Number((value / 10 ** decade).toPrecision(3))} · 10${raised}`;
    }
    return String(Number(value.toPrecision(3))).replace("-", "−");
  }
  const percent = (value) => `${digits(100 * value)} %`;
  function amount(value, unit) {
    if (unit === "s") {
      if (value < 1e-3) return `${digits(1e6 * value)} µs`;
      if (value < 1) return `${digits(1e3 * value)} ms`;
      if (value < 600) return `${digits(value)} s`;
      return value < 36000 ? `${digits(value / 60)} min` : `${digits(value / 3600)} h`;
    }
    if (unit === "B") return value < 1e9 ? `${digits(value / 1e6)} MB` : `${digits(value / 1e9)} GB`;
    return digits(value);
  }

  /** The points of a curve that have an error and a cost, from coarse to fine, and which of them no other one beats. */
  function seen(curve) {
    const points = [];
    for (const point of curve.points) {
      const error = point.errors[chosen.measure];
      const cost = point.costs[chosen.cost];
      if (!error || !cost || error.value === 0 || !(cost.value > 0)) continue;
      points.push({ point, error, cost, x: Math.abs(error.value), y: cost.value });
    }
    const counted = points.filter((one) => !one.error.hollow && !one.error.doubtful && !one.point.trouble);
    const beaten = (one) => counted.some((other) => other !== one && other.x <= one.x && other.y <= one.y && (other.x < one.x || other.y < one.y));
    const front = counted.filter((one) => !beaten(one)).sort((a, b) => a.x - b.x);
    return { points, front };
  }

  /** A colour that is seen on the ground of the page. */
  function shade(colour) {
    const parts = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
    const light = (0.3 * parts[0] + 0.6 * parts[1] + 0.1 * parts[2]) / 255;
    if (colourOf("--is-dark") !== "1" || light > 0.45) return colour;
    return `rgb(${parts.map((part) => Math.round(part + 0.6 * (255 - part))).join(" ")})`;
  }

  function shape(context, marker, x, y, size) {
    context.beginPath();
    if (marker === "circle") context.arc(x, y, size, 0, 2 * Math.PI);
    else if (marker === "square") context.rect(x - 0.9 * size, y - 0.9 * size, 1.8 * size, 1.8 * size);
    else {
      const corners = {
        diamond: [[0, -1.3], [1.3, 0], [0, 1.3], [-1.3, 0]],
        triangle: [[0, -1.25], [1.15, 0.9], [-1.15, 0.9]],
        wedge: [[0, 1.25], [1.15, -0.9], [-1.15, -0.9]],
      }[marker];
      corners.forEach(([dx, dy], k) => context[k ? "lineTo" : "moveTo"](x + size * dx, y + size * dy));
      context.closePath();
    }
  }

  function line(context, places) {
    context.beginPath();
    places.forEach(([x, y], k) => context[k ? "lineTo" : "moveTo"](x, y));
    context.stroke();
  }

  /** Draws one curve: all runs faintly in their order, the best of them in full, and a marker for each. */
  function drawCurve(u, curve, { points, front }) {
    const { ctx: context } = u;
    const ratio = devicePixelRatio;
    const place = (one) => [u.valToPos(one.x, "x", true), u.valToPos(one.y, "y", true)];
    const colour = shade(curve.colour);
    context.setLineDash([]);
    context.lineWidth = 1.5 * ratio;
    context.strokeStyle = colourOf("--grid");
    line(context, points.map(place));
    context.lineWidth = (curve.second ? 1.2 : 2.4) * ratio;
    context.strokeStyle = colour;
    context.setLineDash(curve.dash.map((part) => part * ratio));
    line(context, front.map(place));
    context.setLineDash([]);
    for (const one of points) {
      const [x, y] = place(one);
      context.lineWidth = 1.3 * ratio;
      if (one.cost.range) line(context, one.cost.range.map((value) => [x, u.valToPos(value, "y", true)]));
      if (one.error.range && one.error.range[0] > 0) line(context, one.error.range.map((value) => [u.valToPos(value, "x", true), y]));
      shape(context, curve.marker, x, y, (curve.second ? 3.5 : 5) * ratio);
      context.fillStyle = one.error.hollow || one.point.trouble ? colourOf("--ground") : colour;
      context.fill();
      context.stroke();
      if (one.error.doubtful) {
        context.beginPath();
        context.arc(x, y, 9 * ratio, 0, 2 * Math.PI);
        context.stroke();
      }
    }
  }

  /** What is said of a point. */
  function describe(curve, one, cost) {
    const { point, error } = one;
    const interval = (range, words) => (range ? ` (${words(range[0])} to ${words(range[1])})` : "");
    const rows = [
      ["error", (error.value > 0 ? "" : "−") + percent(Math.abs(error.value)) + interval(error.range, percent)],
      [cost.label, amount(one.cost.value, cost.unit) + interval(one.cost.range, (value) => amount(value, cost.unit)) + (one.cost.runs > 1 ? `, ${one.cost.runs} runs` : "")],
      ["particles", point.particles === null ? "" : digits(point.particles)],
      ["steps", point.steps === null ? "" : digits(point.steps)],
    ];
    const facts = make("dl", {});
    for (const [name, value] of rows) if (value) facts.append(make("dt", { textContent: name }), make("dd", { textContent: value }));
    const notes = [];
    if (error.hollow) notes.push("below ten times the error of the reference: a bound");
    if (error.doubtful) notes.push("lower than other runs lead to expect: perhaps by chance");
    if (point.trouble) notes.push(point.trouble);
    return [
      make("strong", { textContent: `${curve.label} at ${point.spacing}` }),
      facts,
      ...notes.map((textContent) => make("p", { textContent })),
      make("code", { textContent: point.command }),
    ];
  }

  function watch(u, curves, drawn, cost) {
    const tip = make("div", { className: "tip", hidden: true });
    u.over.append(tip);
    const nearest = (left, top) => {
      let best = null;
      drawn.forEach(({ points }, k) => {
        if (!u.series[k + 1].show) return;
        for (const one of points) {
          const place = [u.valToPos(one.x, "x"), u.valToPos(one.y, "y")];
          const distance = Math.hypot(place[0] - left, place[1] - top);
          if (distance < (best ? best.distance : REACH)) best = { curve: curves[k], one, place, distance };
        }
      });
      return best;
    };
    const show = (event) => {
      const box = u.over.getBoundingClientRect();
      const found = nearest(event.clientX - box.left, event.clientY - box.top);
      tip.hidden = !found;
      if (!found) return;
      tip.replaceChildren(...describe(found.curve, found.one, cost));
      const [width, height] = [tip.offsetWidth, tip.offsetHeight];
      const [left, top] = found.place;
      tip.style.left = `${Math.max(Math.min(left + 14, box.width - width - 4), 4 - u.bbox.left / devicePixelRatio)}px`;
      tip.style.top = `${top + 14 + height > box.height && top > height + 14 ? top - height - 14 : top + 14}px`;
    };
    u.over.addEventListener("pointermove", show);
    u.over.addEventListener("pointerdown", show);
    u.over.addEventListener("pointerleave", () => (tip.hidden = true));
  }

  const stretch = (u, low, high) => [low / 1.6, high * 1.6];

  /** Whole multiples of powers of ten within a range, or even steps where it holds too few of them. */
  function splits(u, axis, low, high) {
    const found = [];
    for (let decade = Math.floor(Math.log10(low)); decade <= Math.log10(high); decade++) {
      for (let digit = 1; digit < 10; digit++) {
        const value = digit * 10 ** decade;
        if (value >= low && value <= high) found.push(value);
      }
    }
    if (found.length > 3) return found;
    const rough = (high - low) / 5;
    const unit = 10 ** Math.floor(Math.log10(rough));
    const step = unit * [1, 2, 5, 10].find((digit) => digit * unit >= rough);
    const even = [];
    for (let k = Math.ceil(low / step); k * step <= high; k++) even.push(k * step);
    return even;
  }

  /** Whether a split has a label: the fewer decades there are, the more of them. */
  function isNamed(value, low, high) {
    const digit = Math.round(value / 10 ** Math.floor(Math.log10(value) + 1e-9));
    const span = high / low;
    return span < 8 || digit === 1 || (span < 2e3 && (digit === 2 || digit === 5));
  }

  function draw() {
    const scene = scenes[chosen.scene];
    const { reference, label } = scene.measures[chosen.measure];
    const cost = scene.costs[chosen.cost];
    const curves = scene.curves.filter((curve) => seen(curve).points.length > 0);
    const drawn = curves.map(seen);
    const none = { stroke: new Path2D(), fill: null, clip: null, band: null, gaps: null, flags: 0 };
    const ink = colourOf("--ink");
    const thin = { stroke: colourOf("--grid"), width: 1 };
    const names = (scale, words) => (u, values) => {
      const { min, max } = u.scales[scale];
      return values.map((value) => (isNamed(value, min, max) ? words(value) : ""));
    };
    const axis = (scale, label, words) => ({ label, stroke: ink, grid: thin, ticks: thin, splits, filter: (u, values) => values, values: names(scale, words) });
    const options = {
      width: holder.querySelector(".plot").clientWidth,
      height: Math.max(300, Math.min(460, 0.72 * innerHeight)),
      scales: { x: { time: false, distr: 3, auto: true, range: stretch }, y: { distr: 3, auto: true, range: stretch } },
      axes: [axis("x", label, percent), { ...axis("y", cost.label, (value) => amount(value, cost.unit)), size: 78 }],
      series: [{ label: "error" }, ...curves.map((curve) => ({ label: curve.label, stroke: shade(curve.colour), width: curve.second ? 1.2 : 2.4, dash: curve.dash, paths: () => none, points: { show: false }, show: !chosen.hidden.has(curve.label) }))],
      cursor: { drag: { x: true, y: true, setScale: true, dist: 6 }, points: { show: false }, x: false, y: false },
      legend: { live: false },
      hooks: {
        draw: [
          (u) => {
            const { ctx: context } = u;
            context.save();
            context.beginPath();
            context.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
            context.clip();
            if (reference !== null) {
              context.strokeStyle = colourOf("--quiet");
              context.lineWidth = 1.4 * devicePixelRatio;
              context.setLineDash([3 * devicePixelRatio, 4 * devicePixelRatio]);
              const at = u.valToPos(reference, "x", true);
              line(context, [[at, u.bbox.top], [at, u.bbox.top + u.bbox.height]]);
            }
            drawn.forEach((one, k) => u.series[k + 1].show && drawCurve(u, curves[k], one));
            context.restore();
          },
        ],
        setScale: [(u, name) => name === "x" && zoomed(u)],
        setSeries: [
          (u, k) => {
            if (k === null || !u.series[k]) return;
            chosen.hidden[u.series[k].show ? "delete" : "add"](curves[k - 1].label);
          },
        ],
      },
    };
    const tables = drawn.map(({ points }) => {
      const sorted = [...points].sort((a, b) => a.x - b.x);
      return [sorted.map((one) => one.x), sorted.map((one) => one.y)];
    });
    if (plot) plot.destroy();
    const data = tables.length ? uPlot.join(tables) : [[1e-3, 1e-1]];
    plot = new uPlot(options, data, holder.querySelector(".plot"));
    watch(plot, curves, drawn, cost);
    holder.dataset.points = String(drawn.reduce((sum, { points }) => sum + points.length, 0));
  }

  /** Says what range is seen, and whether that is all. */
  function zoomed(u) {
    const { min, max } = u.scales.x;
    if (min === null) return;
    if (u.whole === undefined) u.whole = `${min} ${max}`;
    Object.assign(holder.dataset, { low: String(min), high: String(max) });
    holder.querySelector(".reset").disabled = u.whole === `${min} ${max}`;
  }

  /** A choice of one of several; none where there is only one. */
  function choice(name, words, labels, choose) {
    const select = make("select", { name }, ...labels.map((label, k) => make("option", { value: k, textContent: label })));
    select.addEventListener("change", () => {
      choose(Number(select.value));
      draw();
    });
    return make("label", { hidden: labels.length < 2 }, `${words} `, select);
  }

  function controls() {
    const scene = scenes[chosen.scene];
    const reset = make("button", { type: "button", className: "reset", textContent: "Whole range", title: "Or double-click the chart" });
    reset.addEventListener("click", draw);
    holder.querySelector(".controls").replaceChildren(
      choice("scene", "Scene", scenes.map((one) => one.title), (k) => {
        Object.assign(chosen, { scene: k, measure: 0, cost: 0, hidden: new Set() });
        controls();
      }),
      choice("measure", "Error", scene.measures.map((one) => one.label), (k) => (chosen.measure = k)),
      choice("cost", "Cost", scene.costs.map((one) => one.label), (k) => (chosen.cost = k)),
      reset,
    );
    holder.querySelector("select[name=scene]").value = chosen.scene;
  }

  const usable = scenes.length > 0 && scenes[0].measures.length > 0 && scenes[0].costs.length > 0;
  if (!usable) return;
  holder.hidden = false;
  document.documentElement.classList.add("charted");
  holder.append(make("div", { className: "controls" }), make("div", { className: "plot" }), make("p", { className: "hint", textContent: "Point at a run for its numbers; drag to zoom, double-click for the whole range; a click on a name hides its curve. Nearer to the lower left corner is better." }));
  controls();
  draw();
  document.addEventListener("themechange", draw);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  let width = innerWidth;
  addEventListener("resize", () => {
    if (innerWidth === width) return;
    width = innerWidth;
    draw();
  });
})();
