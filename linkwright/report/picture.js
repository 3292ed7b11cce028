// A drawing as a file in the colours that it has here: as SVG to be enlarged or printed, as PNG on its page's ground at
// three times its size, or as a page of its size that the browser prints or saves as PDF.
function savePicture(svg, kind) {
  "use strict";
  var kept = ["fill", "stroke", "stroke-width", "stroke-dasharray", "stroke-linecap", "stroke-linejoin", "opacity",
    "vector-effect", "font-family", "font-size", "font-weight"];
  var copy = svg.cloneNode(true), box = svg.getBoundingClientRect(), copies = copy.querySelectorAll("*");
  svg.querySelectorAll("*").forEach(function (each, number) {
    var style = getComputedStyle(each);
    kept.forEach(function (name) { copies[number].style.setProperty(name, style.getPropertyValue(name)); });
  });
  copy.setAttribute("width", box.width);
  copy.setAttribute("height", box.height);
  var source = "data:image/svg+xml;charset=utf-8," + encodeURIComponent(new XMLSerializer().serializeToString(copy));
  var link = document.createElement("a"), image = new Image();
  link.download = (svg.getAttribute("aria-label") || "picture").replace(/[^\w.]+/g, "-").slice(0, 60) + "." + kind;
  if (kind === "svg") {
    link.href = source;
    link.click();
    return;
  }
  if (kind === "pdf") {
    printPicture(copy.outerHTML, box);
    return;
  }
  image.onload = function () {
    var canvas = document.createElement("canvas");
    canvas.width = 3 * box.width;
    canvas.height = 3 * box.height;
    var pen = canvas.getContext("2d");
    pen.fillStyle = getComputedStyle(svg).getPropertyValue("--paper") || "#fff";
    pen.fillRect(0, 0, canvas.width, canvas.height);
    pen.drawImage(image, 0, 0, canvas.width, canvas.height);
    link.href = canvas.toDataURL("image/png");
    link.click();
  };
  image.src = source;
}
// A picture alone on a page of its size, which the browser prints or saves as PDF.
function printPicture(markup, size) {
  "use strict";
  var frame = document.createElement("iframe");
  frame.style.cssText = "position: fixed; width: 0; height: 0; border: 0";
  frame.srcdoc = "<style>@page { size: " + size.width + "px " + size.height + "px; margin: 0 } body { margin: 0 } " +
    "svg, img { display: block }</style>" + markup + "<script>onload = function () { print(); }</" + "script>";
  document.body.appendChild(frame);
}
