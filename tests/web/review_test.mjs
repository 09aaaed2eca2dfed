// SPDX-License-Identifier: Apache-2.0
/**
 * A page with a review, opened from the disk in a real Chromium and worked by mouse and keys, with WebGL2 and without.
 * node review_test.mjs PAGE.html [--exercise]: the latter where the page was held against an exercise and points were lost.
 * @module
 */
import assert from "node:assert/strict";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { Browser } from "./browser.mjs";

const [page, ...options] = process.argv.slice(2);
const isHeld = options.includes("--exercise");
const url = pathToFileURL(resolve(page)).href;

/** In the page: what the canvas shows, as a small picture; waits for it to be drawn. */
const kHelp = `
window.shown = async () => {
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    const from = document.querySelector(".review-stage canvas"), small = document.createElement("canvas");
    [small.width, small.height] = [360, 240];
    const context = small.getContext("2d");
    context.drawImage(from, 0, 0, 360, 240);
    return context.getImageData(0, 0, 360, 240).data;
};
window.differing = (a, b) => {
    let count = 0;
    for (let i = 0; i < a.length; i += 4) if (Math.abs(a[i] - b[i]) + Math.abs(a[i + 1] - b[i + 1]) + Math.abs(a[i + 2] - b[i + 2]) > 24) ++count;
    return count;
};
/** Where pixels differ: their middle, and how far they reach. */
window.where = (a, b) => {
    let count = 0, sx = 0, sy = 0, low = [1e9, 1e9], high = [-1, -1];
    for (let i = 0; i < a.length; i += 4) {
        if (Math.abs(a[i] - b[i]) + Math.abs(a[i + 1] - b[i + 1]) + Math.abs(a[i + 2] - b[i + 2]) <= 24) continue;
        const x = (i / 4) % 360, y = Math.floor(i / 1440);
        ++count; sx += x; sy += y;
        low = [Math.min(low[0], x), Math.min(low[1], y)]; high = [Math.max(high[0], x), Math.max(high[1], y)];
    }
    return { count, x: Math.round(sx / count), y: Math.round(sy / count), wide: high[0] - low[0] + 1, high: high[1] - low[1] + 1 };
};
window.colourAt = (a, x, y) => [...a.slice(4 * (x + 360 * y), 4 * (x + 360 * y) + 3)];
window.like = (a, colour, most) => { let count = 0; for (let i = 0; i < a.length; i += 4) if (colour.every((v, k) => Math.abs(a[i + k] - v) <= most)) ++count; return count; };
/** Of a colour's own kind, whatever light falls on it. */
window.hueLike = (a, colour) => {
    const sum = colour[0] + colour[1] + colour[2];
    let count = 0;
    for (let i = 0; i < a.length; i += 4) { const s = a[i] + a[i + 1] + a[i + 2]; if (s > 60 && colour.every((v, k) => Math.abs(a[i + k] / s - v / sum) < 0.035)) ++count; }
    return count;
};
window.covered = (a) => { let count = 0; for (let i = 0; i < a.length; i += 4) if (Math.abs(a[i] - 180) + Math.abs(a[i + 1] - 190) + Math.abs(a[i + 2] - 201) > 12) ++count; return count; };
window.goTo = (share) => { const s = document.querySelector(".review-transport input"); s.value = share * s.max; s.dispatchEvent(new Event("input")); };
window.violations = [];
document.addEventListener("securitypolicyviolation", (e) => violations.push(e.effectiveDirective));
true`;
const kButton = (text) => `[...document.querySelectorAll(".review-panel button")].find((b) => b.textContent === ${JSON.stringify(text)})`;
const kBur = `document.querySelector(".review-panel input[type=checkbox]")`;
const kTime = `(() => { const [m, s] = document.querySelector(".review-clock").textContent.split(" / ")[0].split(":"); return 60 * m + Number(s); })()`;

async function opened(how) {
    const browser = new Browser(how);
    await browser.open(url);
    await browser.until(`document.querySelector(".review-play")`);
    await browser.evaluate(kHelp);
    return browser;
}
function isClean(browser) {
    assert.deepEqual(browser.console, [], "errors on the console");
    assert.deepEqual(browser.requests.filter((r) => !r.startsWith("data:") && !r.startsWith("file:")), [], "requests");
    assert.equal(browser.requests.filter((r) => r.startsWith("file:")).length, 1, "only the page itself is read");
}

async function withWebGl() {
    const browser = await opened({ webgl: true, width: 900, height: 560 });
    try {
        const changes = async (what, doing) => {
            await browser.evaluate(`shown().then((data) => { window.before = data; })`);
            await doing();
            assert.ok((await browser.evaluate(`shown().then((data) => differing(before, data))`)) > 20, `${what} does not show`);
        };
        // The tooth is there, and the hole comes as time goes and goes as time goes back; only there anything changes.
        await browser.click(kButton("Occlusal"));
        await browser.click(kBur);
        const told = await browser.evaluate(`(async () => {
            goTo(1); const end = await shown();
            goTo(0); const begin = await shown();
            goTo(0.6); const middle = await shown();
            goTo(1); const again = await shown();
            const hole = where(begin, end);
            return { covered: covered(begin), hole, half: differing(begin, middle), again: differing(end, again),
                     before: colourAt(begin, hole.x, hole.y), after: colourAt(end, hole.x, hole.y), beside: colourAt(end, hole.x + 3 * hole.wide, hole.y) };
        })()`);
        assert.ok(told.covered > 13500, `the tooth fills ${told.covered} of 86400`);
        assert.ok(told.hole.count > 50, `the hole is ${told.hole.count} of 86400`);
        assert.ok(told.hole.count > 0.25 * told.hole.wide * told.hole.high, `what changes lies about: ${JSON.stringify(told.hole)}`);
        assert.ok(told.half <= 1.2 * told.hole.count && told.again === 0, JSON.stringify(told));
        const off = (a, b) => Math.hypot(...a.map((v, k) => v - b[k]));
        assert.ok(off(told.before, told.beside) < 12, `before the cut it is as the surface beside it: ${JSON.stringify(told)}`);
        assert.ok(off(told.before, told.after) > 2 * off(told.before, told.beside), `the cut is not to be seen: ${JSON.stringify(told)}`);

        // In a section through it, seen along its normal: the face has the tissue's own colour, and loses about what the
        // bur took. Without the section nothing of it is seen from there.
        const section = await browser.evaluate(`(async () => {
            ${kButton("Mesial")}.click();
            goTo(0); const outside = await shown();
            goTo(1); const hidden = differing(outside, await shown());
            document.querySelector("input[name=review-section][value=x]").click();
            ${kButton("Mesial")}.click();
            const tissue = document.querySelector(".review-legend .chip").style.background.match(/[0-9]+/g).map(Number);
            goTo(0); const face = like(await shown(), tissue, 4);
            goTo(1); const left = like(await shown(), tissue, 4);
            document.querySelector("input[name=review-section][value=none]").click();
            return { face, left, hidden };
        })()`);
        // The block is 12 x 8 mm there.
        const goneMm2 = ((section.face - section.left) / section.face) * 12 * 8;
        assert.ok(section.face > 4000, `the section's face: ${JSON.stringify(section)}`);
        assert.ok(goneMm2 > 0.3 && goneMm2 < 1.6, `${goneMm2} mm2 are gone in the section: ${JSON.stringify(section)}`);
        assert.ok(section.hidden < 10, `${section.hidden} points change where no cut is to be seen`);
        await browser.click(kBur);

        for (const view of ["Buccal", "Mesial", "Lingual", "Distal", "Oblique"]) await changes(view, () => browser.click(kButton(view)));
        await changes("turning by the mouse", async () => {
            const [x, y] = await browser.evaluate(`(() => { const b = document.querySelector(".review-stage canvas").getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; })()`);
            await browser.send("Input.dispatchMouseEvent", { type: "mousePressed", x, y, button: "left", buttons: 1, clickCount: 1 });
            await browser.send("Input.dispatchMouseEvent", { type: "mouseMoved", x: x + 80, y: y + 20, button: "left", buttons: 1 });
            await browser.send("Input.dispatchMouseEvent", { type: "mouseReleased", x: x + 80, y: y + 20, button: "left" });
        });
        await browser.evaluate(`document.querySelector(".review-stage canvas").focus()`);
        for (const key of ["ArrowLeft", "ArrowUp", "+", "-", "0"]) {
            if (key === "0") await browser.key("ArrowRight");
            await changes(`the key ${key}`, () => browser.key(key));
        }
        await changes("Shift and an arrow", () => browser.key("ArrowLeft", 8));

        for (const axis of ["x", "y", "z"]) {
            await changes(`section ${axis}`, () => browser.click(`document.querySelector("input[name=review-section][value=${axis}]")`));
            await changes(`the section's place along ${axis}`, () => browser.evaluate(`(() => { const s = document.querySelector("input[name=review-section]").closest("fieldset").querySelector("input[type=range]"); s.value = 0.3; s.dispatchEvent(new Event("input")); })()`));
        }
        await browser.click(`document.querySelector("input[name=review-section][value=none]")`);

        if (isHeld) {
            await changes("the deviation", () => browser.click(`document.querySelector("input[name=review-colours][value=deviation]")`));
            assert.match(await browser.evaluate(`document.querySelector(".review-legend").textContent`), /0\.50 mm/);
            // The target stands in the colour of "too little is gone", and less of it once it is cut.
            const hue = await browser.evaluate(`(async () => {
                ${kButton("Occlusal")}.click();
                ${kBur}.click();
                const chips = [...document.querySelectorAll(".review-legend .chip")].map((c) => c.style.background.match(/[0-9]+/g).map(Number));
                const least = chips[chips.length - 1];
                goTo(0); const before = hueLike(await shown(), least);
                goTo(1); const after = hueLike(await shown(), least);
                ${kBur}.click();
                return { before, after };
            })()`);
            // A point is 0.014 mm2: some 4 mm2 of the line, of which the bur took a disc of half a square millimetre.
            assert.ok(hue.before > 150 && hue.after < hue.before - 20, `the deviation's colours: ${JSON.stringify(hue)}`);
            await browser.click(`document.querySelector("input[name=review-colours][value=tissues]")`);
        } else assert.equal(await browser.evaluate(`document.querySelectorAll("input[name=review-colours]").length`), 0);

        // Playing, the time line, the curves.
        await browser.evaluate(`goTo(0)`);
        await browser.click(`document.querySelector(".review-play")`);
        await browser.until(`${kTime} > 0.3`);
        await browser.click(`document.querySelector(".review-play")`);
        const stopped = await browser.evaluate(kTime);
        await new Promise((done) => setTimeout(done, 300));
        assert.equal(await browser.evaluate(kTime), stopped, "it plays on");
        const end = Number(await browser.evaluate(`document.querySelector(".review-transport input").max`));
        await browser.click(`document.querySelector(".review-curve.force")`);
        assert.ok(Math.abs((await browser.evaluate(kTime)) - end / 2) < 0.02 * end + 0.1, "a click on a curve goes there");
        await browser.click(`document.querySelector(".review-transport input")`);
        assert.ok(Math.abs((await browser.evaluate(kTime)) - end / 2) < 0.02 * end + 0.1, "a click on the time line goes there");
        assert.ok((await browser.evaluate(`document.querySelectorAll(".review-curve .stroke").length`)) > 1, "strokes");
        const points = `(document.querySelector(".review-curve.depth .line").getAttribute("d").match(/L/g) ?? []).length`;
        assert.ok((await browser.evaluate(points)) > 20, "the depth's curve");

        // Lost points and moments lead to their moment and place.
        const rows = await browser.evaluate(`document.querySelectorAll(".review-row").length`);
        if (isHeld) assert.ok((await browser.evaluate(`document.querySelectorAll(".review-row strong").length`)) > 0, "no lost points");
        for (let i = 0; i < rows; ++i) {
            await browser.click(`document.querySelectorAll(".review-row")[${i}]`);
            const { time, clock, mark } = await browser.evaluate(`shown().then(() => {
                const b = document.querySelector(".review-stage").getBoundingClientRect(), m = document.querySelector(".review-mark"), r = m.getBoundingClientRect();
                return { time: document.querySelectorAll(".review-row")[${i}].querySelector(".time")?.textContent, clock: document.querySelector(".review-clock").textContent.split(" / ")[0],
                         mark: !m.hidden && Math.hypot(r.x + r.width / 2 - b.x - b.width / 2, r.y + r.height / 2 - b.y - b.height / 2) };
            })`);
            if (time) assert.equal(clock, time, "it goes to another moment");
            assert.ok(mark !== false && mark < 12, `the place is not in the middle: ${mark}`);
        }

        // Everything that can be worked has a name.
        const nameless = await browser.evaluate(`[...document.querySelectorAll(".review button, .review input, .review select, .review canvas")].filter((e) => !(e.textContent.trim() || e.getAttribute("aria-label") || e.closest("label"))).length`);
        assert.equal(nameless, 0, "nameless controls");
        isClean(browser);
        // Nothing else may be loaded or run.
        await browser.evaluate(`new Image().src = "http://127.0.0.1:9/x.png", document.head.append(Object.assign(document.createElement("script"), { textContent: "window.ran = true" }))`);
        await browser.until(`violations.length >= 2`, 10);
        assert.equal(await browser.evaluate(`window.ran === undefined`), true, "a strange script ran");
        const refused = await browser.send("Runtime.evaluate", { expression: `(() => { try { return eval("1"); } catch (e) { return e.name; } })()`, returnByValue: true, allowUnsafeEvalBlockedByCSP: false });
        assert.equal(refused.result.value, "EvalError");
    } finally {
        await browser.close();
    }
}

async function withoutWebGl() {
    const browser = await opened({ webgl: false, width: 900, height: 560 });
    try {
        const { message, hasPictures, isCanvas } = await browser.evaluate(`({ message: document.querySelector(".review-message").textContent, hasPictures: document.querySelectorAll("#review-pictures img").length, isCanvas: !document.querySelector(".review-stage canvas").hidden })`);
        assert.match(message, /WebGL2/);
        assert.equal(isCanvas, false);
        if (hasPictures) {
            const [first, last] = await browser.evaluate(`(() => { const i = document.querySelector(".review-stage img"); goTo(0); const a = i.src; goTo(1); return [a, i.src]; })()`);
            assert.ok(first.startsWith("data:image/png") && first !== last, "the pictures do not change");
            await browser.until(`document.querySelector(".review-stage img").naturalWidth > 0`);
        } else console.log("no pictures in the page: made without OpenGL");
        await browser.click(`document.querySelector(".review-curve.force")`);
        assert.ok((await browser.evaluate(kTime)) > 0);
        if (isHeld) await browser.click(`document.querySelectorAll(".review-row")[0]`);
        isClean(browser);
    } finally {
        await browser.close();
    }
}

async function onAPhone() {
    const browser = await opened({ webgl: true, width: 390, height: 844 });
    try {
        assert.equal(await browser.evaluate(`document.scrollingElement.scrollWidth <= 390`), true, "it is wider than the screen");
        isClean(browser);
    } finally {
        await browser.close();
    }
}

await withWebGl();
await withoutWebGl();
await onAPhone();
console.log("ok");
