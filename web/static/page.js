// The page. It draws and sends commands; its worker computes.
import init, { open } from "./slump_web.js";

const notice = document.getElementById("notice");
const KEPT = "slump";

function fail(reason) {
    notice.textContent = `Slump cannot start: ${reason}. It needs WebAssembly and WebGPU or WebGL 2.`;
    notice.hidden = false;
}

// A browser may have no storage, as in a private window.
function kept() {
    try { return localStorage.getItem(KEPT) ?? ""; } catch { return ""; }
}
globalThis.slump_store = (text) => {
    try { localStorage.setItem(KEPT, text); } catch { /* then nothing is kept */ }
};
globalThis.slump_save = (name, bytes) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([bytes]));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
};

try {
    const worker = new Worker("worker.js", { type: "module" });
    // While the worker loads something it receives no messages. Instead it checks if this address still exists: the page
    // revokes the address to cancel the load, and sends the next address with the same message.
    let address = null;
    globalThis.slump_ask = (message, interrupts) => {
        if (interrupts) {
            if (address) URL.revokeObjectURL(address);
            address = URL.createObjectURL(new Blob(["here"]));
        }
        worker.postMessage({ message, address }, [message.buffer]);
    };
    globalThis.slump_answer = () => {};
    globalThis.slump_gives_up = () => false;
    const early = [];
    worker.onmessage = (event) => early.push(event.data);
    worker.onerror = (event) => fail(event.message);
    const module = await WebAssembly.compileStreaming(fetch("slump_web_bg.wasm"));
    worker.postMessage(module);
    await init({ module_or_path: module });
    const page = await open(document.getElementById("canvas"), kept(), location.href);
    early.forEach((message) => page.receive(message));
    worker.onmessage = (event) => page.receive(event.data);
    // For tests.
    globalThis.slump = page;
    notice.hidden = true;
} catch (error) {
    fail(error.message ?? error);
}
