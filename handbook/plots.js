// Draws the plots that notebooks left as data in their pages.
document.addEventListener("DOMContentLoaded", () => {
  for (const place of document.querySelectorAll(".plot")) {
    const figure = JSON.parse(place.querySelector("script").textContent);
    Plotly.newPlot(place, figure.data, { ...figure.layout, autosize: true }, { responsive: true, displaylogo: false });
  }
});
