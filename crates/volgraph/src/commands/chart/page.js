// Shows the method under the pointer: its settings, figures, picture and error map. A click keeps it; another lets go.
const points = JSON.parse(document.getElementById("points").textContent);
const hits = [...document.querySelectorAll(".hit")];
const what = document.getElementById("what");
const picture = document.getElementById("picture");
const map = document.getElementById("map");
const mapEnd = document.getElementById("map-end");
const mapText = document.getElementById("map-text");
let kept = null;

function row(name, value) {
  const tr = document.createElement("tr");
  for (const [text, kind] of [[name, ""], [value, "n"]]) {
    const td = document.createElement("td");
    td.textContent = text;
    td.className = kind;
    tr.append(td);
  }
  return tr;
}

function show(i) {
  const point = points[i];
  hits.forEach((hit) => hit.classList.toggle("on", Number(hit.dataset.point) === i));
  const title = document.createElement("b");
  title.textContent = point.title;
  const table = document.createElement("table");
  for (const [name, value] of point.rows) table.append(row(name, value));
  what.replaceChildren(title, table);
  for (const image of [picture, map]) image.closest("figure").hidden = !point.picture;
  if (!point.picture) return;
  picture.src = point.picture;
  map.src = point.map;
  mapEnd.textContent = point.map_end;
  mapText.textContent = `error × ${point.amplification}, the worst component of each pixel`;
}

for (const hit of hits) {
  const i = Number(hit.dataset.point);
  hit.addEventListener("pointerenter", () => { if (kept === null) show(i); });
  hit.addEventListener("focus", () => { if (kept === null) show(i); });
  hit.addEventListener("click", () => { kept = kept === i ? null : i; show(i); });
}
show(Number(document.getElementById("points").dataset.first));
