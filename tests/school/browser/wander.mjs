// SPDX-License-Identifier: Apache-2.0
/**
 * A real Chromium wanders through a school's pages as each role, along seeded random ways: links, forms filled in as a
 * person or as nobody would, back, a narrow window. Each find is a line of JSON: {invariant, told, step}. Needs no
 * package. node wander.mjs STAGE SEED MINUTES: STAGE is the program school_stage.
 * @module
 */
import { spawn } from "node:child_process";
import { createInterface } from "node:readline";
import { Browser, program } from "../../web/browser.mjs";

const [stage, seedText, minutesText] = process.argv.slice(2);
if (!stage || !Number.isInteger(Number(seedText)) || !(Number(minutesText) > 0)) {
    console.error("node wander.mjs STAGE SEED MINUTES");
    process.exit(2);
}
if (!program) {
    console.log("skipped: needs chromium");
    process.exit(77);
}
const kPassword = "a long enough one", kPeople = { administrator: "a1", teacher: "t1", examiner: "e1", student: "ida" };
const kWords = ["Ida", "s017", "class-one", "12", "-1", "2026-12-01", "", "x".repeat(300), "<b>bold</b>", "歯", "0", "1e9"];
// What would take the walker's own account, or all of the school, from under it.
const kLeave = /\/(logout|login)\b|\/name\b|\/password\b|\/office\/people\/(a1|t1|e1)\b/;
const kAnswersMs = 30000;

/** mulberry32: the same numbers for the same seed. */
function chance(seed) {
    let a = seed >>> 0;
    return () => {
        a = (a + 0x6d2b79f5) >>> 0;
        let t = Math.imul(a ^ (a >>> 15), a | 1);
        t = (t + Math.imul(t ^ (t >>> 7), t | 61)) ^ t;
        return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
    };
}

let step = 0;
const told = new Set();
function find(invariant, text) {
    if (told.has(`${invariant} ${text}`)) return;
    told.add(`${invariant} ${text}`);
    console.log(JSON.stringify({ invariant, told: text, step }));
}

/** Waits for the page that an act leads to; one that gives true leads to none: a file to keep. */
async function after(browser, act, seconds = 4) {
    let came = false;
    browser.loaded = () => (came = true);
    if (await act()) return false; // nothing comes
    for (const end = Date.now() + 1000 * seconds; !came && Date.now() < end; ) await new Promise((done) => setTimeout(done, 30));
    return came;
}

async function go(browser, address) {
    let isFile = false;
    const came = await after(browser, async () => { isFile = Boolean((await browser.send("Page.navigate", { url: address })).errorText); return isFile; }, kAnswersMs / 1000);
    return came || isFile;
}

async function logIn(browser, address, login) {
    await go(browser, `${address}/login`);
    await browser.evaluate(`(() => { document.querySelector("input[name=login]").value = ${JSON.stringify(login)}; document.querySelector("input[name=password]").value = ${JSON.stringify(kPassword)}; })()`);
    await after(browser, () => browser.click('document.querySelector("button[type=submit]")'), 20);
    return !(await browser.evaluate("location.pathname")).startsWith("/login");
}

/** What can be followed or sent here. */
function offers(browser) {
    return browser.evaluate(`({
        links: [...document.querySelectorAll("a[href]")].filter((a) => a.checkVisibility() && a.origin === location.origin).map((a) => a.href.split("#")[0]),
        forms: [...document.querySelectorAll("main form")].map((form, i) => [i, form.action, form.querySelector("button.grave") !== null]),
        at: location.pathname, status: performance.getEntriesByType("navigation")[0]?.responseStatus ?? 200,
    })`);
}

async function fillIn(browser, form, random) {
    const words = Array.from({ length: 12 }, () => kWords[Math.floor(random() * kWords.length)]), picks = Array.from({ length: 12 }, random);
    await browser.evaluate(`(() => {
        const words = ${JSON.stringify(words)}, picks = ${JSON.stringify(picks)};
        [...document.querySelectorAll("main form")][${form}].querySelectorAll("input, textarea, select").forEach((field, i) => {
            const pick = picks[i % 12];
            if (field.type === "hidden" || field.type === "file" || pick < 0.3) return;
            if (field.tagName === "SELECT") field.selectedIndex = Math.floor(pick * field.options.length);
            else if (["checkbox", "radio"].includes(field.type)) field.checked = pick > 0.6;
            else field.value = words[i % 12];
        });
    })()`);
}

async function wander(browser, address, who, random, until) {
    if (!(await logIn(browser, address, kPeople[who]))) return find("school-answers", `${who} cannot log in`);
    const look = async (how) => {
        const page = await offers(browser);
        const where = `${who} at ${page.at.replace(/[0-9a-f]{16,}/g, "ID")}`;
        for (const text of browser.console.splice(0))
            // A form that was refused answers 4xx, which Chromium writes down as an error of the network.
            if (!(how === "form" && /status of 4\d\d/.test(text)) && !/GPU stall|GL Driver Message/.test(text)) find("school-console", `${where}: ${text.slice(0, 300)}`);
        if (page.status >= 500 || (how === "link" && page.status >= 400)) find("school-answers", `${where}: a ${how} leads to ${page.status}`);
        return page;
    };
    let page = await look("link");
    while (Date.now() < until) {
        ++step;
        const links = page.links.filter((link) => !kLeave.test(link)), forms = page.forms.filter(([, action, grave]) => !grave && !kLeave.test(action));
        const roll = random();
        let how = "link";
        if (roll < 0.1) await after(browser, () => browser.evaluate("history.back()"));
        else if (roll < 0.4 && forms.length > 0) {
            const [form] = forms[Math.floor(random() * forms.length)];
            how = "form";
            await fillIn(browser, form, random);
            await after(browser, () => browser.evaluate(`(() => { const form = [...document.querySelectorAll("main form")][${form}]; const button = form.querySelector("button, input[type=submit]"); if (button) button.click(); else form.requestSubmit(); })()`));
        } else if (links.length > 0) {
            const link = links[Math.floor(random() * links.length)];
            if (!(await go(browser, link))) find("school-answers", `${who}: no page within ${kAnswersMs / 1000} s: ${new URL(link).pathname}`);
        } else how = "none";
        page = await look(how);
        if (how === "none" || page.at.startsWith("/login")) {
            if (!(await logIn(browser, address, kPeople[who]))) return;
            page = await look("link");
        }
    }
}

const server = spawn(stage, [], { stdio: ["pipe", "pipe", "inherit"] });
const address = await new Promise((done, failed) => {
    createInterface({ input: server.stdout }).once("line", done);
    server.once("exit", () => failed(new Error("the stage ended")));
});
const random = chance(Number(seedText)), roles = Object.keys(kPeople), each = (60000 * Number(minutesText)) / roles.length;
try {
    for (const who of roles) {
        const browser = new Browser({ webgl: false });
        try {
            await browser.open("about:blank");
            await wander(browser, address, who, random, Date.now() + each);
        } finally {
            await browser.close();
        }
    }
} finally {
    server.stdin.end();
}
if (server.exitCode !== null) find("school-answers", `the server ended with ${server.exitCode}`);
console.log(`${step} steps of ${roles.length} roles`);
