// The worker: it computes. Between two turns it takes in what the page has sent.
import init, { Engine } from "./slump_web.js";

const early = [];
let engine = null;
let timer = 0;
let is_due = false;

globalThis.slump_answer = (message) => postMessage(message, [message.buffer]);
for (const name of ["slump_ask", "slump_save", "slump_store"]) globalThis[name] = () => {};

// A message to itself comes at once and after those that wait; a timer would take 4 ms.
const self_channel = new MessageChannel();
self_channel.port1.onmessage = () => {
    is_due = false;
    turn();
};
function turn_soon() {
    if (!is_due) self_channel.port2.postMessage(0);
    is_due = true;
}

function turn() {
    clearTimeout(timer);
    const wait = engine.turn();
    if (wait === 0) turn_soon();
    else if (wait > 0) timer = setTimeout(turn_soon, wait);
}

async function start(module) {
    await init({ module_or_path: module });
    engine = new Engine();
    early.forEach((message) => engine.receive(message));
    turn_soon();
}

self.onmessage = ({ data }) => {
    if (data instanceof WebAssembly.Module) {
        start(data);
    } else if (engine) {
        engine.receive(data);
        turn_soon();
    } else {
        early.push(data);
    }
};
