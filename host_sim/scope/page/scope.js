"use strict";
let rows = 0;
const state = document.getElementById("state");
new EventSource("events").addEventListener("rows", (e) => {
  rows += JSON.parse(e.data).rows.length;
  state.textContent = rows + " rows";
});
