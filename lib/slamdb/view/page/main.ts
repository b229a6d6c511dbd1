// To be replaced by the viewer.
const header = document.querySelector('script[data-name="header"]');
document.getElementById("view")!.textContent = header ? `${header.textContent!.length} letters of header` : "no data";
