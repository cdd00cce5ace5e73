// Text that the page holds packed; a browser that cannot unpack it shows the pictures.
async function unpacked(element) {
  const packed = Uint8Array.from(atob(element.textContent), (c) => c.charCodeAt(0));
  const plain = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(plain).text();
}

// Draws each figure as a reader comes near it, and makes legends, tables and contents answer.
(() => {
  "use strict";
  const kinds = JSON.parse(document.getElementById("kinds").textContent);
  const value = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const touch = matchMedia("(hover: none) and (pointer: coarse)").matches; // there a drag scrolls the page
  const config = {
    responsive: true,
    displaylogo: false,
    showSendToCloud: false, // nothing leaves this page
    displayModeBar: touch,
    modeBarButtons: [["zoom2d", "pan2d", "resetScale2d"]],
    doubleClick: "reset",
  };

  // ---- figures -------------------------------------------------------------------------------

  const figures = [...document.querySelectorAll(".figure")].map((element) => ({
    element,
    graphs: [...element.querySelectorAll(".graph")],
    panels: undefined, // read when it is drawn: the page answers sooner
    hidden: new Set(),
    state: "waiting",
  }));

  function coloured(panel, hidden) {
    const ink = value("--ink"), soft = value("--soft"), rule = value("--rule"), card = value("--card");
    const axis = (given) => ({
      ...given,
      gridcolor: rule,
      linecolor: soft,
      tickcolor: soft,
      showline: true,
      ticks: "outside",
      ticklen: 4,
      tickfont: { color: soft, size: 12 },
      title: { ...given.title, font: { color: ink, size: 13 } },
      minor: given.minor && { ...given.minor, tickcolor: soft, showgrid: false },
    });
    return {
      data: panel.data.map((trace) => {
        if (trace.type === "heatmap") return trace;
        const color = value(kinds[trace.meta.kind]);
        return {
          ...trace,
          visible: !hidden.has(trace.meta.entry),
          line: { ...trace.line, color },
          marker: { ...trace.marker, color, line: { color: card, width: 1 } },
        };
      }),
      layout: {
        ...panel.layout,
        xaxis: axis(panel.layout.xaxis),
        yaxis: axis(panel.layout.yaxis),
        dragmode: touch ? false : "zoom",
        font: { family: getComputedStyle(document.body).fontFamily, color: ink, size: 13 },
        hoverlabel: { bgcolor: card, bordercolor: soft, font: { color: ink, size: 13 } },
        modebar: { bgcolor: "rgba(0,0,0,0)", color: soft, activecolor: ink },
        paper_bgcolor: "rgba(0,0,0,0)",
        plot_bgcolor: "rgba(0,0,0,0)",
        uirevision: "kept", // a change of face or of what is shown keeps the zoom
      },
    };
  }

  let library;
  async function unpack() {
    const script = document.createElement("script");
    script.textContent = await unpacked(document.getElementById("plotly"));
    document.head.append(script);
  }

  async function draw(figure) {
    if (figure.state !== "waiting") return;
    figure.state = "drawing";
    try {
      await (library ??= unpack());
      figure.panels = JSON.parse(await unpacked(figure.element.querySelector(".described")));
      for (const [index, graph] of figure.graphs.entries()) {
        const { data, layout } = coloured(figure.panels[index], figure.hidden);
        graph.given = figure.panels[index].layout;
        await new Promise((go) => setTimeout(go)); // a reader comes first
        await Plotly.newPlot(graph, data, layout, config);
        graph.on("plotly_relayout", (change) => follow(figure, index, change));
        graph.addEventListener("keydown", (event) => steer(graph, event));
      }
      figure.state = "drawn";
      figure.element.classList.add("drawn");
    } catch (error) {
      figure.state = "failed";
      figure.element.classList.add("failed"); // shows the pictures instead
      for (const button of figure.element.querySelectorAll("button")) button.disabled = true;
      console.error(error);
    }
  }

  async function redraw(figure) {
    if (figure.state !== "drawn") return;
    for (const [index, graph] of figure.graphs.entries()) {
      const { data, layout } = coloured(figure.panels[index], figure.hidden);
      await Plotly.react(graph, data, layout, config);
    }
  }

  // Panels that show one quantity over the same range are zoomed together.
  let following = false;
  async function follow(figure, index, change) {
    const moved = Object.keys(change).filter((key) => key.startsWith("xaxis."));
    if (following || moved.length === 0) return;
    following = true;
    const same = Object.fromEntries(moved.map((key) => [key, change[key]]));
    for (const [other, graph] of figure.graphs.entries()) {
      if (other === index || figure.panels[other].linked !== figure.panels[index].linked) continue;
      await Plotly.relayout(graph, same);
    }
    following = false;
  }

  // The axes as the figure has them: from end to end where it says so, else what the curves need.
  function home(graph) {
    const change = {};
    for (const name of ["xaxis", "yaxis"]) {
      const range = graph.given[name].range;
      change[range ? `${name}.range` : `${name}.autorange`] = range ? [...range] : true;
    }
    return change;
  }

  // The same by keyboard: arrows move, plus and minus zoom, 0 goes back.
  function steer(graph, event) {
    const step = { ArrowLeft: [-0.15, 0], ArrowRight: [0.15, 0], ArrowDown: [0, -0.15], ArrowUp: [0, 0.15] }[event.key];
    const half = { "+": 0.35, "=": 0.35, "-": 0.7 }[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (!step && !half && event.key !== "0") return;
    event.preventDefault();
    if (event.key === "0") {
      Plotly.relayout(graph, home(graph));
      return;
    }
    const change = {};
    for (const [number, name] of ["xaxis", "yaxis"].entries()) {
      const [low, high] = graph._fullLayout[name].range;
      const centre = (low + high) / 2 + (step ? step[number] * (high - low) : 0);
      const reach = (high - low) * (half ?? 0.5);
      change[`${name}.range[0]`] = centre - reach;
      change[`${name}.range[1]`] = centre + reach;
    }
    Plotly.relayout(graph, change);
  }

  for (const figure of figures) {
    const buttons = [...figure.element.querySelectorAll(".entry")];
    const isShown = (button) => button.getAttribute("aria-pressed") === "true";
    function show(wanted) {
      for (const [button, shown] of buttons.map((one) => [one, wanted(one)])) {
        button.setAttribute("aria-pressed", String(shown));
        figure.hidden[shown ? "delete" : "add"](Number(button.dataset.entry));
      }
      redraw(figure);
    }
    // The curves of one engine alone; once more, and all are back.
    function isolate(chosen) {
      const own = (button) => button.dataset.kind === chosen.dataset.kind;
      const alone = buttons.every((button) => isShown(button) === own(button));
      show((button) => alone || own(button));
    }
    for (const button of buttons) {
      button.disabled = false;
      button.addEventListener("click", (event) => {
        if (event.shiftKey) isolate(button);
        else show((one) => (one === button ? !isShown(one) : isShown(one)));
      });
      button.addEventListener("dblclick", () => isolate(button)); // two clicks left all as it was
    }
    figure.element.querySelector(".reset").addEventListener("click", async () => {
      following = true;
      for (const graph of figure.graphs) {
        if (graph.data) await Plotly.relayout(graph, home(graph));
      }
      following = false;
    });
  }

  // Nothing is drawn before a reader comes near it: the page answers at once, however long it is.
  const watcher = new IntersectionObserver(
    (seen) => seen.filter((one) => one.isIntersecting).forEach((one) => {
      watcher.unobserve(one.target);
      draw(figures.find((figure) => figure.element === one.target));
    }),
    { rootMargin: "600px" },
  );
  figures.forEach((figure) => watcher.observe(figure.element));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => figures.forEach(redraw));

  // ---- tables --------------------------------------------------------------------------------

  function sort(head, ascending) {
    const column = head.cellIndex, body = head.closest("table").tBodies[0];
    const numeric = head.classList.contains("number");
    const key = (row) => {
      const cell = row.cells[column], text = cell.textContent.trim().toLowerCase();
      if (numeric) return cell.title || undefined; // its exact value
      return cell.dataset.sort ?? (text === "–" ? undefined : text);
    };
    const order = (a, b) => (numeric ? Number(a) - Number(b) : a.localeCompare(b, "en", { numeric: true }));
    const rows = [...body.rows].sort((one, other) => {
      const a = key(one), b = key(other);
      if (a === undefined || b === undefined) return (a === undefined) - (b === undefined); // last
      return ascending ? order(a, b) : order(b, a);
    });
    body.append(...rows);
    for (const other of head.parentElement.cells) other.removeAttribute("aria-sort");
    head.setAttribute("aria-sort", ascending ? "ascending" : "descending");
  }
  for (const button of document.querySelectorAll("thead button")) {
    const head = button.parentElement;
    button.addEventListener("click", () => sort(head, head.getAttribute("aria-sort") !== "ascending"));
  }

  // A link to a case opens the list that it stands in.
  const cases = document.querySelector(".all-cases");
  function unfold() {
    const target = location.hash.startsWith("#case-") && document.getElementById(location.hash.slice(1));
    if (!target || !cases) return;
    cases.open = true;
    target.scrollIntoView();
  }
  addEventListener("hashchange", unfold);
  unfold();

  // ---- contents ----------------------------------------------------

  const contents = document.querySelector("nav details");
  const wide = matchMedia("(min-width: 72rem)");
  const fold = () => { contents.open = wide.matches; };
  wide.addEventListener("change", fold);
  fold();
})();
