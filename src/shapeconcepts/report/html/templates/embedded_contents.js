// What the page is made of.
const contents = JSON.parse(document.getElementById("contents").textContent);
