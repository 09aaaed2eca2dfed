// SPDX-License-Identifier: Apache-2.0
/**
 * A real Chromium walks through every page of a school's server, as each role, by the links that the pages have, in
 * both languages; and sends every form as it stands and with nonsense. Fails at errors on the console, answers that are
 * errors, serious findings of axe-core, what no key reaches, and pages wider than a phone.
 * node walk.mjs STAGE OUT: STAGE is the program school_stage; OUT gets a picture of each page and walk.json.
 * @module
 */
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { createServer as createHttpServer } from "node:http";
import { join } from "node:path";
import { createInterface } from "node:readline";
import axe from "axe-core";
import puppeteer from "puppeteer-core";

const [stage, out] = process.argv.slice(2);
assert.ok(stage && out, "node walk.mjs STAGE OUT");
mkdirSync(out, { recursive: true });

const kPassword = "a long enough one", kPeople = { administrator: "a1", teacher: "t1", examiner: "e1", student: "ida" };
const kMostOfAKind = 2, kMostTabs = 80;
const findings = [], seen = [];
const find = (what) => { findings.push(what); console.log(`FINDING ${what}`); };

/** The same page of another thing is the same kind. */
function kindOf(address) {
    const url = new URL(address);
    return url.pathname.split("/").map((part, i, all) => i > 1 && /^(classes|people|attempts|assignments|live|exercises|rubrics|exams|stations|accounts|marking)$/.test(all[i - 1]) && !/^(new|live|marking|export|exams)$/.test(part) ? "ID" : /^[0-9a-f]{16,}$/.test(part) ? "ID" : part).join("/");
}

async function lookAt(page, who, kind, language) {
    const name = `${language}-${who}${kind.replaceAll("/", "_")}`;
    await page.evaluate(axe.source);
    const result = await page.evaluate(() => axe.run({ resultTypes: ["violations"] }));
    for (const v of result.violations)
        if (["serious", "critical"].includes(v.impact)) find(`${name}: axe ${v.id} (${v.impact}): ${v.help}: ${v.nodes.slice(0, 2).map((n) => n.html.slice(0, 160)).join(" | ")}`);
    const about = await page.evaluate(() => ({
        title: document.title, language: document.documentElement.lang, heads: document.querySelectorAll("h1").length,
        wanted: [...document.querySelectorAll("a[href], button, input:not([type=hidden]), select, textarea")].filter((e) => e.checkVisibility() && !e.disabled && !(e.type === "radio" && e !== (document.querySelector(`input[name="${e.name}"]:checked`) ?? document.querySelector(`input[name="${e.name}"]`)))).length,
    }));
    if (!about.title || about.heads !== 1 || about.language !== language) find(`${name}: title "${about.title}", ${about.heads} h1, language ${about.language}`);
    // What can be used is reached by the key alone, and one sees where one is.
    const reached = await page.evaluate(() => { document.activeElement?.blur(); window.reached = new Set(); return 0; });
    void reached;
    const tabs = Math.min(about.wanted, kMostTabs);
    // Tables that can be moved and the parts of a date are stops of their own.
    const stops = await page.evaluate(() => document.querySelectorAll("[tabindex='0']").length + 8 * document.querySelectorAll("input[type^=date]").length);
    for (let i = 0; i < tabs + 3 + stops; ++i) {
        await page.keyboard.press("Tab");
        const bare = await page.evaluate(() => {
            const at = document.activeElement;
            if (!at || at === document.body) return null;
            window.reached.add(at);
            const style = getComputedStyle(at);
            return style.outlineStyle === "none" && style.boxShadow === "none" ? at.outerHTML.slice(0, 120) : null;
        });
        if (bare) { find(`${name}: no focus to be seen: ${bare}`); break; }
    }
    const count = await page.evaluate(() => [...window.reached].filter((e) => e.matches("a[href], button, input, select, textarea")).length);
    if (count < tabs) find(`${name}: ${count} of ${about.wanted} reached by Tab`);
    await page.screenshot({ path: join(out, `${name}.png`), fullPage: true });
    await page.setViewport({ width: 390, height: 844 });
    const wide = await page.evaluate(() => document.scrollingElement.scrollWidth);
    if (wide > 391) find(`${name}: ${wide} wide on a phone of 390`);
    await page.setViewport({ width: 1366, height: 768 });
}

async function logIn(page, address, login) {
    await page.goto(`${address}/login`);
    await page.type("input[name=login]", login);
    await page.type("input[name=password]", kPassword);
    await Promise.all([page.waitForNavigation(), page.click("button[type=submit]")]);
}

/** Every form, as it stands and with nonsense: a sentence, never an error of the server. */
async function sendForms(page, address, who, from, sentOnce, next) {
    await page.goto(from, { waitUntil: "load" });
    const count = await page.evaluate(() => document.querySelectorAll("main form").length);
    for (let i = 0; i < count; ++i)
        for (const how of ["with nonsense", "as it stands"]) {
            await page.goto(from, { waitUntil: "load" });
            // Read in the page, sent from here: the page's own policy lets no script send anything.
            const form = await page.evaluate((i) => {
                const form = document.querySelectorAll("main form")[i];
                if (!form || form.querySelector("button.grave")) return null;
                const button = form.querySelector("button[name]");
                return { action: form.action, isFile: form.enctype === "multipart/form-data", isGet: form.method === "get",
                    data: [...new FormData(form)].map(([name, value]) => [name, value instanceof File ? null : value]).concat(button ? [[button.name, button.value]] : []) };
            }, i);
            // Nobody renames the account that the walk goes on with.
            if (!form || /\/office\/people\/(a1|t1|e1|s017)\/name/.test(form.action)) continue;
            const once = `${kindOf(form.action)} ${form.data.map(([name, value]) => name === "token" ? "" : form.isFile || value === null ? name : `${name}`)} ${how}`;
            if (sentOnce.has(once)) continue;
            sentOnce.add(once);
            const junk = ["-1e999", "<script>alert(1)</script>", "'; DROP TABLE people; --", "\u0000x", "../../etc/passwd"];
            let k = 0;
            const data = form.data.map(([name, value]) => [name, how === "with nonsense" && name !== "token" ? (value === null ? new File([junk[k++ % 5]], "x") : junk[k++ % 5]) : value ?? new File([], "")]);
            const body = form.isFile ? new FormData() : new URLSearchParams(data);
            if (form.isFile) for (const [name, value] of data) body.append(name, value);
            const headers = { Cookie: (await page.cookies(address)).map((c) => `${c.name}=${c.value}`).join("; ") };
            const answer = form.isGet ? await fetch(`${form.action.split("?")[0]}?${body}`, { headers }) : await fetch(form.action, { method: "POST", body, headers, redirect: "manual" });
            const sent = { action: new URL(form.action).pathname, status: answer.status, text: (await answer.text()).slice(0, 4000) };
            if (!sent) continue;
            seen.push({ who, form: sent.action, how, status: sent.status });
            if (answer.headers.get("location")) next.push(new URL(answer.headers.get("location"), address).href);
            if (sent.status >= 500) find(`${who} ${sent.action} ${how}: ${sent.status} ${sent.text.slice(0, 200)}`);
            if (sent.text.includes("<script>alert(1)")) find(`${who} ${sent.action}: a script comes back as one`);
        }
}

async function walk(browser, address, who, language, forms) {
    const context = await browser.createBrowserContext();
    const page = await context.newPage();
    await page.setViewport({ width: 1366, height: 768 });
    await page.setExtraHTTPHeaders({ "Accept-Language": `${language},en;q=0.5` });
    page.setBypassCSP(false);
    let at = "", isSending = false;
    // A page whose thing a form has changed may be gone; what the driver of a drawing surface thinks is its own affair.
    page.on("console", (m) => { if (["error", "warn"].includes(m.type()) && !(isSending && /status of 40[34]/.test(m.text())) && !/GPU stall|GL Driver Message/.test(m.text())) find(`${language} ${who} ${at}: console: ${m.text()}`); });
    page.on("pageerror", (e) => find(`${language} ${who} ${at}: ${e.message}`));
    page.on("requestfailed", (r) => { if (!/ERR_ABORTED/.test(r.failure()?.errorText ?? "")) find(`${language} ${who} ${at}: ${r.url()} ${r.failure()?.errorText}`); });
    page.on("request", (r) => { if (!r.url().startsWith(address) && !/^(data|blob):/.test(r.url())) find(`${language} ${who} ${at}: asks elsewhere: ${r.url()}`); });
    if (who === "student") { await page.goto(`${address}/login`); await lookAt(page, "nobody", "/login", language); }
    await logIn(page, address, kPeople[who]);
    const waiting = [page.url()], known = new Set(waiting), kinds = new Map(), withForms = [], sentOnce = new Set();
    while (waiting.length > 0) {
        at = waiting.shift();
        const kind = kindOf(at), times = kinds.get(kind) ?? 0;
        if (times < kMostOfAKind) {
            kinds.set(kind, times + 1);
            let answer = null;
            try { answer = await page.goto(at, { waitUntil: "load" }); } catch (e) {
                // A file to keep is no page.
                if (!/ERR_ABORTED/.test(e.message)) throw e;
                seen.push({ who, language, address: kind, status: "file" });
            }
            if (answer) {
                seen.push({ who, language, address: kind, status: answer.status() });
                if (answer.status() >= 400) find(`${language} ${who}: a link leads to ${answer.status()}: ${kind}`);
                else if (/text\/html/.test(answer.headers()["content-type"])) {
                    if (times === 0) await lookAt(page, who, kind, language);
                    if (forms) withForms.push(at);
                    for (const next of await page.evaluate(() => [...document.querySelectorAll("a[href]")].map((a) => a.href.split("#")[0])))
                        if (next.startsWith(address) && !known.has(next)) { known.add(next); waiting.push(next); }
                }
            }
        }
        // All that can be reached was looked at: now forms, and what they lead to.
        while (waiting.length === 0 && withForms.length > 0) {
            const next = [];
            isSending = true;
            await sendForms(page, address, who, (at = withForms.shift()), sentOnce, next);
            isSending = false;
            // Another page now, also where it was seen before.
            for (const one of next) { kinds.delete(kindOf(one)); known.add(one); waiting.push(one); }
        }
    }
    await context.close();
}

/**
 * Bars move by themselves (apps/web/live), and when they are full the page comes anew, unless somebody fills in a form.
 * @param {import("puppeteer-core").Browser} browser
 */
async function seeBarsMove(browser) {
    let done = 0, loads = 0;
    const live = readFileSync(new URL("../../../apps/web/live/live.js", import.meta.url));
    const bars = createHttpServer((request, response) => {
        const is = (word) => request.url.includes(word);
        response.setHeader("content-type", is("live.js") ? "text/javascript" : "text/html");
        if (is("live.js")) return response.end(live);
        if (is("?progress")) ++done;
        else if (request.url === "/") ++loads;
        response.end(`<!DOCTYPE html><p role="status"><progress max="2" value="${done}"></progress> ${done} of 2</p>` +
            (done < 2 ? '<div id="keep-up" data-from="?progress"></div>' : "") + '<form><input id="typed"></form>' +
            (is("?progress") ? "" : '<script type="module" src="/live.js"></script>'));
    });
    await new Promise((up) => bars.listen(0, "127.0.0.1", up));
    const page = await browser.newPage(), says = (text) => page.waitForFunction((wanted) => document.body.textContent.includes(wanted), { timeout: 30000 }, text);
    for (const isTyping of [false, true]) {
        done = loads = 0;
        await page.goto(`http://127.0.0.1:${bars.address().port}/`);
        if (isTyping) await page.type("#typed", "half");
        await says("1 of 2");
        if (await page.$eval("progress", (bar) => bar.value) !== 1 || loads !== 1) find("a bar does not move by itself");
        await says("2 of 2");
        await new Promise((later) => setTimeout(later, 1000));
        if (loads !== (isTyping ? 1 : 2)) find(`a page whose bar is full was loaded ${loads} times${isTyping ? ", under somebody's hands" : ""}`);
    }
    await page.close();
    bars.close();
}

const server = spawn(stage, [], { stdio: ["pipe", "pipe", "inherit"] });
const address = await new Promise((done, failed) => {
    createInterface({ input: server.stdout }).once("line", done);
    server.once("exit", () => failed(new Error("the stage ended")));
});
const browser = await puppeteer.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox", "--disable-gpu", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
try {
    await seeBarsMove(browser);
    for (const language of ["en", "ja"])
        for (const who of Object.keys(kPeople)) await walk(browser, address, who, language, language === "en");
} finally {
    await browser.close();
    server.stdin.end();
}
writeFileSync(join(out, "walk.json"), JSON.stringify({ seen, findings }, null, 1));
const pages = new Set(seen.filter((s) => s.address).map((s) => `${s.who} ${s.address}`));
console.log(`${pages.size} pages by role, ${seen.filter((s) => s.form).length} forms sent, ${findings.length} findings`);
process.exitCode = findings.length > 0 ? 1 : 0;
