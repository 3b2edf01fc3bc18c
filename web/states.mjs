// Compares the page's module in node with the program, without a browser: node web/states.mjs PAGE PROGRAM [STEPS]
//
// PAGE is the folder that web/build.sh made, PROGRAM the program `slump`. Eight scenes with five steppers must reach the
// same state in both, bit for bit.
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";

const [page, program] = process.argv.slice(2, 4).map((path) => resolve(path));
const steps = Number(process.argv[4] ?? 2000);
const time_step_secs = 5e-4;
const scenes = ["pile", "moving-walls", "cradle", "drum", "shear", "vibrated", "newtons-cradle", "chain"];
const steppers = ["moreau", "range", "dem", "avbd", "tgs-soft"];

// Functions that the module expects from a page.
for (const name of ["slump_answer", "slump_ask", "slump_gives_up", "slump_save", "slump_store"]) globalThis[name] = () => {};
const { initSync, state_of } = await import(join(page, "slump_web.js"));
initSync({ module: readFileSync(join(page, "slump_web_bg.wasm")) });

// Hash of the program's last state; null if the program refuses the run.
function state_of_program(options) {
    const folder = mkdtempSync(join(tmpdir(), "slump-"));
    const picture = ["--size", "64x48", "--renderer", "cpu", "--fps", "1"];
    const length = ["--duration", String(steps * time_step_secs)];
    const { status } = spawnSync(program, ["--headless", "--frames", folder, ...picture, ...options, ...length]);
    const manifest = status === 2 ? null : readFileSync(join(folder, "manifest.json"));
    rmSync(folder, { recursive: true });
    if (manifest === null) return null;
    const [run] = JSON.parse(manifest).runs;
    if (run.step !== steps && run.ended !== "not-finite") throw new Error(`${run.step} steps of ${steps}`);
    return run.last_state;
}

let tried = 0;
const others = [];
for (const scene of scenes) {
    for (const stepper of steppers) {
        const options = ["--scene", scene, "--stepper", stepper, "--dt", String(time_step_secs)];
        const expected = state_of_program(options);
        if (expected === null) continue;
        tried += 1;
        const link = `slump://run?scene=${scene}&stepper=${stepper}&dt=${time_step_secs}&to=${steps}`;
        if (state_of(link) !== expected) others.push(`${scene} by ${stepper}`);
    }
}
console.log(`${tried - others.length} of ${tried} runs of ${steps} steps have the program's state, bit for bit`);
if (tried < 35 || others.length) throw new Error(`other states: ${others.join(", ")}`);
