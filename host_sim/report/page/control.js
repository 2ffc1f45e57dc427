/* control.js - the command line of the page. It is served with --control alone, and works with the token behind the
 * # of the page's address. The plant's side is host_sim/scope/control.h. */
"use strict";

const TRIGGER_SETTINGS = {"lift-off": 2, touchdown: 1, level: 1};
const line = make("input", {id: "command", ariaLabel: "command",
  placeholder: "start + arm force amplitude=3 frequency=225 + fire --hold 60"});
let hold = "", sent = 0;
const answer = make("pre", {role: "status"});

/* What the answer says stands below the command; of a burst it says only how it went. */
function show(text) {
  answer.textContent = text.split("\n").filter((l) => !/^(\d+|sample),/.test(l)).slice(-6).join("\n").trim();
}

/* The answer to the newest command comes in parts, the last of them when its session ends. A command without --hold keeps that of the one
 * before, which it ends. */
async function send(words) {
  hold = /stop|disable/.test(words) ? "" : / --hold[ =]\S+/.exec(words)?.[0] ?? hold;
  words += words.includes(" --hold") ? "" : hold;
  const number = ++sent;
  let text = "";
  const tell = (more) => {
    text += more;
    if (number === sent)
      show(text);
  };
  answer.className = "";
  tell(`> ${words}\n`);
  try {
    const got = await fetch("send/" + shown.about.plant,
      {method: "POST", body: words, headers: {Authorization: "Bearer " + location.hash.slice(1)}});
    const reader = got.body.getReader(), decoder = new TextDecoder();
    for (let part; !(part = await reader.read()).done;)
      tell(decoder.decode(part.value));
  } catch (e) {
    tell("no answer: " + e.message);
  }
  if (number === sent)
    answer.className = text.endsWith("exit 0\n") ? "" : "bad";
}

/* Asks for a burst, which the page then shows whatever its trigger says. */
function takeBurst() {
  const setting = TRIGGER_SETTINGS[find("trigger").value];
  shown.takes = true;
  send((setting ? `set capture_trigger=${setting} + capture arm` : "capture arm + capture trigger") + " + capture read");
}

function showCommandLine() {
  const card = make("section", {className: "card", ariaLabel: "Commands"});
  card.append(make("h2", {textContent: "Commands, as to contactplant send"}), line, answer);
  Object.assign(answer.style, {whiteSpace: "pre-wrap", overflowWrap: "anywhere", margin: "4px 0 0"});
  Object.assign(line.style, {width: "100%", maxWidth: "none"});
  find("side").prepend(card);
  line.onkeydown = (e) => e.key === "Enter" && send(line.value);
  keys.c = takeBurst;
  put("role", "listens and commands");
}

showCommandLine();
