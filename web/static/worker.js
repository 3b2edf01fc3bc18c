// The worker. It computes, and receives the messages of the page between two turns.
import init, { Engine } from "./slump_web.js";

const early = [];
let engine = null;
let timer = 0;
let is_due = false;
let address = null;
let looked_at = 0;

globalThis.slump_answer = (message) => postMessage(message, [message.buffer]);
for (const name of ["slump_ask", "slump_save", "slump_store"]) globalThis[name] = () => {};

// True once the page has revoked the address that came with the last message. A check takes a millisecond.
globalThis.slump_gives_up = () => {
    if (!address || performance.now() - looked_at < 100) return false;
    looked_at = performance.now();
    try {
        const look = new XMLHttpRequest();
        look.open("GET", address, false);
        look.send();
        return false;
    } catch {
        return true;
    }
};

// A message to itself arrives at once, after the waiting messages; a timer would take 4 ms.
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

function receive(data) {
    address = data.address;
    engine.receive(data.message);
    turn_soon();
}

async function start(module) {
    await init({ module_or_path: module });
    engine = new Engine();
    early.forEach(receive);
    turn_soon();
}

self.onmessage = ({ data }) => {
    if (data instanceof WebAssembly.Module) {
        start(data);
    } else if (engine) {
        receive(data);
    } else {
        early.push(data);
    }
};
