// SPDX-License-Identifier: Apache-2.0
/**
 * A browser without a window, spoken to through its own DevTools protocol on a pipe: no package needed.
 * @module
 */
import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const kPrograms = [process.env.HANDPIECE_CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
/** Where Chromium is; null where there is none. */
export const program = kPrograms.find((path) => path && existsSync(path)) ?? null;

export class Browser {
    /** @param {{webgl: boolean, width?: number, height?: number}} how */
    constructor({ webgl, width = 1366, height = 768 }) {
        this.folder = mkdtempSync(join(tmpdir(), "handpiece-web-"));
        const gl = webgl ? ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"] : ["--disable-gpu", "--disable-3d-apis"];
        this.process = spawn(/** @type {string} */ (program), ["--headless=new", "--no-sandbox", "--remote-debugging-pipe", "--no-first-run", "--disable-extensions",
            "--disable-background-networking", "--disable-component-update", `--user-data-dir=${this.folder}`, `--window-size=${width},${height}`, ...gl, "about:blank"],
            { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
        this.size = { width, height };
        this.next = 1;
        this.waiting = new Map();
        /** What the page's console, its errors and its requests told. */
        this.console = [];
        this.requests = [];
        let rest = "";
        this.process.stdio[4].setEncoding("utf8").on("data", (part) => {
            const pieces = (rest + part).split("\0");
            rest = pieces.pop();
            for (const piece of pieces) this.hear_(JSON.parse(piece));
        });
    }
    hear_(message) {
        const { id, method, params } = message;
        if (id) {
            const { done, failed } = this.waiting.get(id);
            this.waiting.delete(id);
            message.error ? failed(new Error(JSON.stringify(message.error))) : done(message.result);
        } else if (method === "Runtime.exceptionThrown") this.console.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
        else if (method === "Runtime.consoleAPICalled" && ["error", "warning", "assert"].includes(params.type)) this.console.push(params.args.map((a) => a.value ?? a.description).join(" "));
        else if (method === "Log.entryAdded" && ["error", "warning"].includes(params.entry.level)) this.console.push(params.entry.text);
        else if (method === "Network.requestWillBeSent") this.requests.push(params.request.url.slice(0, 200));
        else if (method === "Page.loadEventFired") this.loaded?.();
    }
    send(method, params = {}) {
        const id = this.next++;
        this.process.stdio[3].write(JSON.stringify({ id, method, params, sessionId: this.session }) + "\0");
        return new Promise((done, failed) => this.waiting.set(id, { done, failed }));
    }
    async open(url) {
        if (!this.session) {
            const { targetInfos } = await this.send("Target.getTargets");
            const { sessionId } = await this.send("Target.attachToTarget", { targetId: targetInfos.find((t) => t.type === "page").targetId, flatten: true });
            this.session = sessionId;
            for (const domain of ["Page", "Runtime", "Log", "Network"]) await this.send(`${domain}.enable`);
            await this.send("Emulation.setDeviceMetricsOverride", { ...this.size, deviceScaleFactor: 1, mobile: false });
        }
        this.console.length = this.requests.length = 0;
        const loaded = new Promise((done) => (this.loaded = done));
        await this.send("Page.navigate", { url });
        await loaded;
    }
    /** What an expression of the page comes to; promises are waited for. */
    async evaluate(expression) {
        const { result, exceptionDetails } = await this.send("Runtime.evaluate", { expression, awaitPromise: true, returnByValue: true });
        if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
        return result.value;
    }
    /** Until an expression is true. */
    async until(expression, seconds = 240) {
        for (const end = Date.now() + 1000 * seconds; Date.now() < end; await new Promise((done) => setTimeout(done, 50)))
            if (await this.evaluate(expression)) return;
        throw new Error(`not within ${seconds} s: ${expression}\n${this.console.join("\n")}`);
    }
    /** By a real click of the mouse in the middle of an element. */
    async click(selector) {
        const [x, y] = await this.evaluate(`(() => { const e = ${selector}; e.scrollIntoView({ block: "center" }); const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; })()`);
        for (const type of ["mousePressed", "mouseReleased"]) await this.send("Input.dispatchMouseEvent", { type, x, y, button: "left", buttons: type === "mousePressed" ? 1 : 0, clickCount: 1 });
    }
    async key(key, modifiers = 0) {
        for (const type of ["keyDown", "keyUp"]) await this.send("Input.dispatchKeyEvent", { type, key, code: key, modifiers });
    }
    /** Bytes of a PNG of what is to be seen. */
    async picture() {
        const { data } = await this.send("Page.captureScreenshot", { format: "png" });
        return Buffer.from(data, "base64");
    }
    async close() {
        const gone = new Promise((done) => this.process.once("exit", done));
        this.send("Browser.close").catch(() => {});
        await Promise.race([gone, new Promise((done) => setTimeout(done, 5000))]);
        if (this.process.exitCode === null) this.process.kill("SIGKILL");
        // Its helpers write there for a moment longer.
        rmSync(this.folder, { recursive: true, force: true, maxRetries: 20, retryDelay: 250 });
    }
}
