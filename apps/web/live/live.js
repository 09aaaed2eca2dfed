// SPDX-License-Identifier: Apache-2.0
/**
 * Keeps the tiles of a page up (app/report/live_pages.cpp): asks once a second what is new, and gets with one answer
 * all figures and those pictures that changed. docs/school-live.md
 * @module
 */

/** @typedef {{ station: string, who: string, state: string, figures: string, flags: string[], sequence: number, bytes: number }} Tile */

const kPeriodMs = 1000, kPatienceMs = 8000;

/** Ends what takes too long. */
function patience() {
    const patience = new AbortController();
    setTimeout(() => patience.abort(), kPatienceMs);
    return patience.signal;
}

/**
 * The length of the JSON (32 bits, low byte first), the JSON, the pictures in its order.
 * @param {ArrayBuffer} bytes
 * @returns {{ sequence: number, tiles: Tile[], pictures: Map<string, Blob> }}
 */
export function unpackFeed(bytes) {
    const length = new DataView(bytes).getUint32(0, true);
    const { sequence, tiles } = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length)));
    const pictures = new Map();
    let from = 4 + length;
    for (const tile of tiles) {
        if (tile.bytes > 0) pictures.set(tile.station, new Blob([bytes.slice(from, from + tile.bytes)], { type: "image/jpeg" }));
        from += tile.bytes;
    }
    return { sequence, tiles, pictures };
}

export class LivePage {
    /** @param {HTMLElement} list */
    constructor(list) {
        this.list = list;
        this.since = 0;
        /** @type {Map<string, Set<string>>} what was told of a station */
        this.told = new Map();
        this.isFirst = true;
    }

    /** @param {string} text */
    trouble(text) {
        const place = document.getElementById("live-trouble");
        if (place && place.textContent !== text) place.textContent = text;
    }

    /**
     * @param {Tile} tile
     * @returns {HTMLElement}
     */
    itemOf(tile) {
        const found = this.list.querySelector(`[data-station="${tile.station}"]`);
        if (found instanceof HTMLElement) return found;
        const item = document.createElement("li"), link = document.createElement("a"), picture = document.createElement("img");
        item.dataset.station = tile.station;
        link.href = `/live/${tile.station}`;
        picture.width = 480;
        picture.height = 300;
        const name = document.createElement("strong"), figures = document.createElement("div");
        figures.className = "figures";
        link.append(picture, name);
        item.append(link, figures);
        this.list.append(item);
        return item;
    }

    /**
     * @param {HTMLImageElement} picture
     * @param {Blob | undefined} blob
     * @param {Tile} tile
     */
    showPicture(picture, blob, tile) {
        picture.alt = (this.list.dataset.picture ?? "{}").replace("{}", tile.who);
        const before = picture.src;
        if (blob) picture.src = URL.createObjectURL(blob);
        else if (tile.state === "gone") picture.removeAttribute("src");
        else return;
        if (before.startsWith("blob:")) URL.revokeObjectURL(before);
    }

    /** @param {ArrayBuffer} bytes */
    take(bytes) {
        const { sequence, tiles, pictures } = unpackFeed(bytes);
        this.since = sequence;
        const news = [];
        for (const tile of tiles) {
            const item = this.itemOf(tile);
            item.className = tile.state;
            const picture = item.querySelector("img"), figures = item.querySelector(".figures"), name = item.querySelector("strong");
            if (picture) this.showPicture(picture, pictures.get(tile.station), tile);
            if (name && name.textContent !== tile.who) name.textContent = tile.who;
            // The server's own, with nothing in it that runs.
            if (figures && figures.innerHTML !== tile.figures) figures.innerHTML = tile.figures;
            const told = this.told.get(tile.station) ?? new Set();
            for (const flag of tile.flags)
                if (!told.has(flag)) news.push(`${tile.who}: ${flag}`);
            this.told.set(tile.station, new Set(tile.flags));
        }
        for (const item of [...this.list.children])
            if (item instanceof HTMLElement && !tiles.some((tile) => tile.station === item.dataset.station)) item.remove();
        document.getElementById("live-none")?.toggleAttribute("hidden", tiles.length > 0);
        // Only what has just happened is read out, not what was so when the page was opened.
        const place = document.getElementById("live-news");
        if (place && news.length > 0 && !this.isFirst) place.textContent = news.join(". ");
        this.isFirst = false;
    }

    async ask() {
        const { feed = "", silent = "", ended = "" } = this.list.dataset;
        try {
            const answer = await fetch(`${feed}?since=${this.since}`, { signal: patience(), redirect: "error" });
            if (answer.ok) {
                this.take(await answer.arrayBuffer());
                this.trouble("");
            } else this.trouble(answer.status === 403 ? ended : silent);
        } catch {
            this.trouble(silent);
        }
    }

    async run() {
        for (;;) {
            const began = performance.now();
            // What nobody sees is not asked for.
            if (document.visibilityState === "visible") await this.ask();
            await new Promise((done) => setTimeout(done, Math.max(100, kPeriodMs - (performance.now() - began))));
        }
    }
}

/** Asks for this very page until something else stands there. */
async function waitForIt(/** @type {HTMLElement} */ place) {
    for (;;) {
        await new Promise((done) => setTimeout(done, 2 * kPeriodMs));
        if (document.visibilityState !== "visible") continue;
        try {
            const answer = await fetch(location.href, { signal: patience() });
            const page = new DOMParser().parseFromString(await answer.text(), "text/html"), again = page.getElementById("again");
            if (!again) return location.reload();
            if (place.textContent !== again.textContent) place.textContent = again.textContent;
        } catch {
            // The server comes back, or the person goes.
        }
    }
}

/** What is not read out at every step. */
const kStepMs = 5000;

/**
 * Moves a page's bars as the page at `from` has them, until they are full; then the rest is worth to be seen as well,
 * unless somebody fills in a form just now.
 * @param {string} from
 */
async function keepUp(from) {
    for (;;) {
        await new Promise((done) => setTimeout(done, kStepMs));
        if (document.visibilityState !== "visible") continue;
        try {
            const answer = await fetch(from, { signal: patience(), redirect: "error" });
            if (!answer.ok) return;
            const page = new DOMParser().parseFromString(await answer.text(), "text/html");
            const bars = page.querySelectorAll("[role=status]:has(> progress)");
            document.querySelectorAll("[role=status]:has(> progress)").forEach((bar, i) => {
                if (bars[i] && bar.innerHTML !== bars[i].innerHTML) bar.replaceChildren(...bars[i].childNodes);
            });
            if (page.getElementById("keep-up")) continue;
            if (!document.activeElement?.closest("form")) location.reload();
            return;
        } catch {
            // The server comes back, or the person goes.
        }
    }
}

const list = document.getElementById("live");
if (list) new LivePage(list).run();
const again = document.getElementById("again");
if (again) waitForIt(again);
const bars = document.getElementById("keep-up");
if (bars) keepUp(bars.dataset.from ?? "");
