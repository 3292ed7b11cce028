(function () {
  "use strict";
  var figures = JSON.parse(document.getElementById("figures").textContent);
  var places = Array.prototype.slice.call(document.querySelectorAll("[data-figure]"));
  function colour(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  }
  function dressed(layout) {
    var ink = colour("--ink"), line = colour("--line");
    var axis = { gridcolor: line, linecolor: line, tickcolor: line, automargin: true };
    return Object.assign({}, layout, {
      autosize: true,
      paper_bgcolor: "rgba(0,0,0,0)",
      plot_bgcolor: "rgba(0,0,0,0)",
      colorway: [colour("--error"), colour("--after")],
      font: { color: ink, size: 12, family: getComputedStyle(document.body).fontFamily },
      xaxis: Object.assign({}, layout.xaxis, axis),
      yaxis: Object.assign({}, layout.yaxis, axis)
    });
  }
  function draw() {
    places.forEach(function (place) {
      var figure = figures[place.dataset.figure];
      Plotly.react(place, figure.data, dressed(figure.layout), { responsive: true, displaylogo: false, displayModeBar: false });
    });
  }
  draw();
  if (window.matchMedia) {
    var dark = window.matchMedia("(prefers-color-scheme: dark)");
    if (dark.addEventListener) { dark.addEventListener("change", draw); }
  }
  window.addEventListener("beforeprint", function () { places.forEach(function (place) { Plotly.Plots.resize(place); }); });
}());
