// SPDX-License-Identifier: Apache-2.0
// A built site from the disk in a real browser: every page without an error and without a request elsewhere, search that finds, light and dark, a phone's width.
//   node tests/docs/site_test.mjs SITE
import assert from "node:assert";
import { readdirSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { Browser, program } from "../web/browser.mjs";

if (!program) {
    console.log("there is no Chromium here");
    process.exit(77);
}
const site = resolve(process.argv[2]);
const address = (page) => pathToFileURL(join(site, page)).href;
const browser = new Browser({ webgl: true });
const quiet = (page) => {
    assert.deepEqual(browser.console, [], page);
    assert.deepEqual(browser.requests.filter((url) => !/^(file|data|blob|about):/.test(url)), [], page);
};
try {
    const pages = readdirSync(site, { recursive: true }).map(String).filter((name) => name.endsWith(".html")).sort();
    for (const page of pages) {
        await browser.open(address(page));
        quiet(page);
    }

    // In both languages, and a name of the code.
    for (const [words, page] of [["remaining dentine", "docs/assessment.html"], ["マウス", "docs/user-guide.ja.html"], ["burInTooth", "cpp/tick-contact.html"]]) {
        await browser.open(`${address("search.html")}?q=${encodeURIComponent(words)}`);
        await browser.until(`[...document.querySelectorAll("#search-results li a")].some((a) => a.href.includes(${JSON.stringify(page)}))`, 30);
        quiet(`search for ${words}`);
    }
    await browser.open(`${address("search.html")}?q=xyzzyxyzzy`);
    await browser.until(`document.querySelector("#search-results p")?.textContent.includes("did not match")`, 30);

    // The switch: from the system's to light or dark, and the other.
    await browser.open(address("index.html"));
    const grounds = new Set();
    for (let i = 0; i < 3; ++i) {
        await browser.click(`[...document.querySelectorAll(".theme-toggle")].find((e) => e.getClientRects().length)`);
        grounds.add(await browser.evaluate(`getComputedStyle(document.body).backgroundColor`));
    }
    assert.equal(grounds.size, 2, "light and dark");

    browser.size.width = 390;
    await browser.send("Emulation.setDeviceMetricsOverride", { width: 390, height: 800, deviceScaleFactor: 1, mobile: true });
    for (const page of ["index.html", "docs/cli.html", "docs/physics.html", "docs/review.html", "cpp/tick-contact.html"]) {
        await browser.open(address(page));
        assert.ok(await browser.evaluate(`document.documentElement.scrollWidth <= innerWidth`), `${page} is wider than a phone`);
    }
    console.log(`${pages.length} pages`);
} finally {
    await browser.close();
}
