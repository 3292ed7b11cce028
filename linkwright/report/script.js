(function () {
  "use strict";
  var figures = {};
  var places = Array.prototype.slice.call(document.querySelectorAll("[data-figure]"));
  function colour(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  }
  function dressed(layout) {
    var ink = colour("--ink"), line = colour("--line");
    var axis = { gridcolor: line, linecolor: line, tickcolor: line };
    var axes = { automargin: true };
    var space = layout.scene && { scene: Object.assign({}, layout.scene) };
    (space ? ["x", "y", "z"] : []).forEach(function (name) {
      space.scene[name + "axis"] = Object.assign({}, layout.scene[name + "axis"], axis);
    });
    var plane = space || {
      xaxis: Object.assign({}, layout.xaxis, axis, axes),
      yaxis: Object.assign({}, layout.yaxis, axis, axes)
    };
    return Object.assign({}, layout, plane, {
      autosize: true,
      paper_bgcolor: "rgba(0,0,0,0)",
      plot_bgcolor: "rgba(0,0,0,0)",
      modebar: { bgcolor: "rgba(0,0,0,0)", color: colour("--muted") },
      colorway: [colour("--error"), colour("--after")],
      font: { color: ink, size: 12, family: getComputedStyle(document.body).fontFamily }
    });
  }
  // A figure that is like another one in other colours, for paper, where there is no button.
  function whole(figure) {
    var like = figures[figure.like];
    if (!like) { return figure; }
    var first = Object.assign({}, like.data[0]);
    if (first.marker) {
      first.marker = Object.assign({}, first.marker, { cmin: figure.from, cmax: figure.to });
    } else {
      first.zmin = figure.from;
      first.zmax = figure.to;
    }
    return { data: [first].concat(like.data.slice(1)), layout: Object.assign({}, like.layout, { updatemenus: [] }) };
  }
  function saved() {
    return { name: "svg", title: "Download plot as an SVG", icon: Plotly.Icons.disk, click: function (place) {
      Plotly.downloadImage(place, { format: "svg", filename: place.dataset.figure });
    } };
  }
  function printed() {
    var sheet = { width: 500, height: 500, path: "M90 0H310L410 100V500H90Z" };
    return { name: "pdf", title: "Print plot or save it as PDF", icon: sheet, click: function (place) {
      var box = place.getBoundingClientRect();
      Plotly.toImage(place, { format: "svg", width: box.width, height: box.height }).then(function (image) {
        printPicture("<img src='" + image.replace(/'/g, "%27") + "' alt=''>", box);
      });
    } };
  }
  function draw() {
    places.forEach(function (place) {
      var figure = whole(figures[place.dataset.figure]);
      Plotly.react(place, figure.data, dressed(figure.layout), { responsive: true, displaylogo: false, displayModeBar: true, modeBarButtons: [["toImage", saved(), printed()]] });
    });
  }
  function unpacked(id) {
    var letters = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz!#$%,()*+-;.=>?@^_`{|}~";
    var worth = {}, packed = document.getElementById(id).textContent;
    for (var n = 0; n < 85; n += 1) { worth[letters[n]] = n; }
    var bytes = new Uint8Array(4 * Math.ceil(packed.length / 5));
    for (var at = 0, to = 0; at < packed.length; at += 5, to += 4) {
      var value = 0;
      for (var k = at; k < at + 5; k += 1) { value = 85 * value + (k < packed.length ? worth[packed[k]] : 84); }
      for (var part = 3; part >= 0; part -= 1) { bytes[to + part] = value % 256; value = Math.floor(value / 256); }
    }
    bytes = bytes.subarray(0, Math.floor(packed.length * 4 / 5));
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
  }
  function missing(words) {
    places.forEach(function (place) { place.textContent = words; });
  }
  document.querySelectorAll("svg").forEach(function (drawing) {
    var row = document.createElement("span");
    row.className = "save";
    ["png", "svg", "pdf"].forEach(function (kind) {
      var button = document.createElement("button"), name = kind.toUpperCase();
      button.textContent = name;
      button.setAttribute("aria-label", name + " of " + (drawing.getAttribute("aria-label") || "this drawing"));
      button.onclick = function () { savePicture(drawing, kind); };
      row.appendChild(button);
    });
    drawing.after(row);
  });
  if (!places.length) { return; }
  if (!window.DecompressionStream) {
    missing("This browser is too old to draw it; the result file has the figures.");
    return;
  }
  Promise.all([unpacked("plotly"), unpacked("figures")]).then(function (texts) {
    figures = JSON.parse(texts[1]);
    var script = document.createElement("script");
    script.textContent = texts[0];
    document.head.appendChild(script);
    draw();
    if (window.matchMedia) {
      var dark = window.matchMedia("(prefers-color-scheme: dark)");
      if (dark.addEventListener) { dark.addEventListener("change", draw); }
    }
    // The page's own layout on paper is not there to be asked before it is printed: A4 within its margins.
    window.addEventListener("beforeprint", function () {
      places.forEach(function (place) {
        Plotly.relayout(place, { autosize: false, width: place.closest(".columns-2, .paper") ? 330 : 680, height: 290 });
      });
    });
    window.addEventListener("afterprint", function () {
      places.forEach(function (place) { Plotly.relayout(place, { autosize: true, width: null, height: null }); });
    });
  });
}());
