// SPDX-License-Identifier: Apache-2.0
/**
 * A review on a page: picture, time line, lists, and what turns and plays them.
 * @module
 */
import { ToothAtTime, indexAt } from "./review.js";
import { ToothPicture, axesOf, matrixOf, projected } from "./draw.js";

/**
 * @typedef {[number, number, number]} Vec3
 * @typedef {import("./review.js").Review} Review
 * @typedef {import("./draw.js").Camera} Camera
 */

const kSvg = "http://www.w3.org/2000/svg";
const kSpeeds = [0.25, 1, 4, 16, 64];
/** Of the curves, in units of their own. */
const kWide = 1000, kHigh = 70;
const kTurnDeg = 10, kPanShare = 0.08, kZoom = 1.15;
/** A bur that lies lower works from a side. A place is looked at from so much beside the bur, which would hide it. */
const kFromASideDeg = 35, kBesideDeg = 28;

/**
 * @param {string} tag @param {Record<string, string>} [attributes] @param {(Node | string)[]} children
 * @returns {any} an element
 */
function element(tag, attributes = {}, ...children) {
    const made = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
    made.append(...children);
    return made;
}
/** @param {string} tag @param {Record<string, string | number>} attributes @returns {SVGElement} */
function svg(tag, attributes) {
    const made = document.createElementNS(kSvg, tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
    return made;
}
/** @param {number} seconds */
function clock(seconds) {
    const tenths = Math.round(seconds * 10), minutes = Math.floor(tenths / 600);
    return `${minutes}:${((tenths - 600 * minutes) / 10).toFixed(1).padStart(4, "0")}`;
}
/** @param {number} value @param {number} least @param {number} most */
const within = (value, least, most) => Math.min(Math.max(value, least), most);

export class ReviewPage {
    /**
     * @param {HTMLElement} host is filled @param {Review} review
     * @param {{picture: HTMLImageElement, timeS: number}[]} pictures shown where there is no WebGL2
     */
    constructor(host, review, pictures) {
        this.review = review;
        this.words = review.text.words;
        this.pictures = pictures;
        this.tooth = new ToothAtTime(review);
        this.timeS = review.text.durationS;
        this.speed = 1;
        this.isPlaying = false;
        this.isDeviation = false;
        this.isBur = true;
        this.isAround = true;
        /** @type {{axis: string, offset: number} | null} */
        this.section = null;
        /** @type {Vec3 | null} */
        this.markMm = null;
        this.isAsked = false;
        this.box = this.boxOf_();
        this.lowestCutMm = this.box.high[2];
        this.middleMm = this.middleOfCut_();
        /** @type {SVGElement[]} */
        this.heads = [];
        this.camera = this.first_();

        this.heading_(host);
        this.stage_();
        this.timeLine_();
        this.controls_();
        this.lists_();
        host.append(
            element("div", { class: "review-body" },
                element("div", { class: "review-left" }, element("div", { class: "review-picture" }, this.stage, this.legend), ...review.text.notes.map((note) => element("p", { class: "review-note" }, note)), this.transport, this.curves),
                element("div", { class: "review-side" }, this.panel, this.lists)));
        this.hands_();
        new ResizeObserver(() => this.ask()).observe(this.stage);
        this.go(this.timeS);
    }

    /** @param {HTMLElement} host */
    heading_(host) {
        host.replaceChildren(element("h2", {}, this.words.heading));
    }

    /**
     * A place of the grid.
     * @param {number} node @param {number} axis
     */
    mm_(node, axis) {
        const { originMm, voxelMm } = this.review.text.grid;
        return originMm[axis] + voxelMm * node;
    }

    /** Where the uncut tooth lies. */
    boxOf_() {
        const { nodes } = this.review.text.grid, { uncut } = this.review;
        const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
        for (let z = 0, i = 0; z < nodes[2]; ++z)
            for (let y = 0; y < nodes[1]; ++y)
                for (let x = 0; x < nodes[0]; ++x, ++i)
                    if (uncut[i] < 128)
                        [x, y, z].forEach((n, k) => {
                            low[k] = Math.min(low[k], n);
                            high[k] = Math.max(high[k], n);
                        });
        /** @param {number[]} n @returns {Vec3} */
        const place = (n) => [this.mm_(n[0], 0), this.mm_(n[1], 1), this.mm_(n[2], 2)];
        return { low: place(low), high: place(high) };
    }

    /**
     * The middle of all that was cut, or of the tooth: sections begin there.
     * @returns {Vec3}
     */
    middleOfCut_() {
        const { bricks, brickEdge } = this.review.text.grid, { low, high } = this.box;
        const cutLow = [Infinity, Infinity, Infinity], cutHigh = [-Infinity, -Infinity, -Infinity];
        for (const brick of this.review.bricks)
            [brick % bricks[0], Math.floor(brick / bricks[0]) % bricks[1], Math.floor(brick / (bricks[0] * bricks[1]))].forEach((b, k) => {
                cutLow[k] = Math.min(cutLow[k], b);
                cutHigh[k] = Math.max(cutHigh[k], b + 1);
            });
        if (this.review.bricks.length) this.lowestCutMm = this.mm_(cutLow[2] * brickEdge, 2);
        /** @param {number} k */
        const middle = (k) => (this.review.bricks.length ? this.mm_(((cutLow[k] + cutHigh[k]) / 2) * brickEdge, k) : (low[k] + high[k]) / 2);
        return [middle(0), middle(1), middle(2)];
    }

    /** @param {string} name @returns {Camera} */
    standard(name) {
        const { low, high } = this.box, b = this.review.text.buccalSign;
        const wide = Math.max(high[0] - low[0], high[1] - low[1]);
        // The crown, and down to where it was cut.
        const crown = Math.min(high[2] - low[2], Math.max(0.75 * wide, high[2] - this.lowestCutMm + 1));
        /** @type {Vec3} */
        const targetMm = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, high[2] - crown / 2];
        /** @type {Record<string, [number, number]>} */
        const views = { oblique: [56 * b, 41], occlusal: [90 * b, 89.9], buccal: [90 * b, 0], lingual: [-90 * b, 0], mesial: [0, 0], distal: [180, 0] };
        const [yawDeg, pitchDeg] = views[name];
        // An upper tooth hangs, as who sits before the patient sees it.
        return { targetMm, yawDeg, pitchDeg, distanceMm: Math.max(wide, crown) * 2.9, isHanging: this.review.text.isUpper ?? false };
    }

    /**
     * Where the bur's shank points at a pose: whence the hand comes.
     * @param {number} pose
     */
    whence_(pose) {
        const [w, x, y, z] = this.review.turnOf(pose);
        const towards = [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)];
        return { yawDeg: (Math.atan2(towards[1], towards[0]) * 180) / Math.PI, pitchDeg: (Math.asin(within(towards[2], -1, 1)) * 180) / Math.PI };
    }

    /**
     * To begin with: oblique, or from where most was cut, if that is from a side.
     * @returns {Camera}
     */
    first_() {
        const { tipDepthMm } = this.review, camera = this.standard("oblique");
        let deepest = 0;
        for (let i = 1; i < tipDepthMm.length; ++i) if (tipDepthMm[i] > tipDepthMm[deepest]) deepest = i;
        const { yawDeg, pitchDeg } = this.whence_(deepest);
        return this.review.bricks.length && pitchDeg < kFromASideDeg ? { ...camera, yawDeg, pitchDeg: pitchDeg + 15 } : camera;
    }

    stage_() {
        this.canvas = element("canvas", { tabindex: "0", role: "img", "aria-label": this.words["tooth-label"], "aria-describedby": "review-help" });
        this.mark = element("div", { class: "review-mark", hidden: "" });
        this.fallback = element("img", { alt: this.words["tooth-label"], hidden: "" });
        this.message = element("p", { class: "review-message", role: "status", hidden: "" });
        this.legend = element("ul", { class: "review-legend", "aria-label": this.words.legend });
        /** @type {ToothPicture | null} */
        this.picture = null;
        this.stage = element("div", { class: "review-stage" }, this.canvas, this.fallback, this.mark, this.message);
        try {
            this.picture = new ToothPicture(this.canvas, this.review, this.tooth.distance);
        } catch (error) {
            this.canvas.hidden = true;
            this.message.hidden = false;
            this.message.textContent = this.pictures.length ? this.words["no-webgl"] : this.words["no-webgl-no-pictures"];
            this.fallback.hidden = !this.pictures.length;
            this.legend.hidden = true;
        }
        // For print, and for who cannot see the tooth itself.
        document.getElementById("review-pictures")?.classList.toggle("review-spare", this.picture !== null);
        this.canvas.addEventListener("webglcontextlost", (/** @type {Event} */ e) => e.preventDefault());
        this.canvas.addEventListener("webglcontextrestored", () => {
            this.picture = new ToothPicture(this.canvas, this.review, this.tooth.distance);
            this.ask();
        });
    }

    timeLine_() {
        const { words, review } = this, end = review.text.durationS;
        this.playButton = element("button", { type: "button", class: "review-play" });
        this.playButton.addEventListener("click", () => this.play(!this.isPlaying));
        this.slider = element("input", { type: "range", min: "0", max: String(end), step: "0.05", "aria-label": words.time });
        this.slider.addEventListener("input", () => {
            this.play(false);
            this.go(Number(this.slider.value));
        });
        this.clock = element("output", { class: "review-clock" });
        /** @param {string} sign @param {string} name @param {() => number | undefined} where */
        const leap = (sign, name, where) => {
            const button = element("button", { type: "button", class: "review-leap", "aria-label": name, title: name }, sign);
            button.addEventListener("click", () => {
                this.play(false);
                this.go(where() ?? this.timeS);
            });
            return button;
        };
        const begins = review.text.strokes.map(([from]) => from);
        // Half a second: whoever leaps back twice means the stroke before.
        const back = leap("|◀", words["stroke-before"], () => begins.filter((t) => t < this.timeS - 0.5).pop() ?? 0);
        const on = leap("▶|", words["stroke-next"], () => begins.find((t) => t > this.timeS + 0.01) ?? end);
        const speeds = element("select", { "aria-label": words.speed });
        for (const speed of kSpeeds) speeds.append(element("option", { value: String(speed) }, `${speed}×`));
        speeds.value = "1";
        speeds.addEventListener("change", () => (this.speed = Number(speeds.value)));
        this.transport = element("div", { class: "review-transport" }, this.playButton, back, on, this.slider, this.clock, speeds);

        /** @param {number} timeS */
        const x = (timeS) => (end > 0 ? (kWide * timeS) / end : 0);
        /** @param {string} name @param {ArrayLike<number>} times @param {ArrayLike<number>} values @param {string} unit @param {string} kind @param {number} least */
        const curve = (name, times, values, unit, kind, least) => {
            let most = 0.1;
            for (let i = 0; i < values.length; ++i) most = Math.max(most, values[i]);
            const drawing = svg("svg", { viewBox: `0 0 ${kWide} ${kHigh}`, preserveAspectRatio: "none", class: `review-curve ${kind}`, role: "img" });
            drawing.setAttribute("aria-label", `${name}: ${words["at-most"].replace("{}", `${most.toFixed(2)} ${unit}`)}`);
            for (const [from, to] of review.text.strokes)
                drawing.append(svg("rect", { class: "stroke", x: x(from), y: 0, width: Math.max(x(to) - x(from), 0.5), height: kHigh }));
            let path = "";
            for (let i = 0; i < values.length; ++i)
                path += `${i ? "L" : "M"}${x(times[i]).toFixed(1)} ${(kHigh - (kHigh - 4) * (Math.max(values[i], least) / most)).toFixed(1)}`;
            drawing.append(svg("path", { d: path || "M0 0", class: "line", "vector-effect": "non-scaling-stroke" }));
            for (const { timeS } of review.text.moments)
                drawing.append(svg("line", { class: "moment", x1: x(timeS), x2: x(timeS), y1: 0, y2: kHigh, "vector-effect": "non-scaling-stroke" }));
            for (const { timeS } of review.text.errors ?? [])
                if (timeS !== undefined) drawing.append(svg("line", { class: "error", x1: x(timeS), x2: x(timeS), y1: 0, y2: kHigh, "vector-effect": "non-scaling-stroke" }));
            const head = svg("line", { class: "head", y1: 0, y2: kHigh, "vector-effect": "non-scaling-stroke" });
            drawing.append(head);
            this.heads.push(head);
            const seek = (/** @type {PointerEvent} */ e) => {
                if (!(e.buttons & 1)) return;
                const box = drawing.getBoundingClientRect();
                this.play(false);
                this.go(within((e.clientX - box.left) / box.width, 0, 1) * end);
            };
            drawing.addEventListener("pointerdown", /** @type {any} */ (seek));
            drawing.addEventListener("pointermove", /** @type {any} */ (seek));
            const now = element("span", { class: "now" });
            return { now, box: element("figure", { class: "review-figure" }, element("figcaption", {}, element("span", {}, name), element("span", { class: "most" }, `${words["at-most"].replace("{}", `${most.toFixed(2)} ${unit}`)}`), now), drawing) };
        };
        const force = curve(words.force, review.curveTimesS, review.forceN, "N", "force", 0);
        const depth = curve(words.depth, review.poseTimesS, review.tipDepthMm, "mm", "depth", 0);
        this.forceNow = force.now;
        this.depthNow = depth.now;
        this.curves = element("div", { class: "review-curves" }, force.box, depth.box, element("p", { class: "review-note" }, words["curves-note"]));
    }

    controls_() {
        const { words, review } = this;
        /** @param {string} label @param {any[]} inside */
        const group = (label, ...inside) => element("fieldset", {}, element("legend", {}, label), ...inside);
        const views = ["oblique", "occlusal", "buccal", "lingual", "mesial", "distal"].map((name) => {
            const button = element("button", { type: "button" }, words[`view-${name}`]);
            button.addEventListener("click", () => {
                this.camera = this.standard(name);
                this.ask();
            });
            return button;
        });
        /** @param {string} name @param {string} value @param {string} label @param {boolean} on @param {() => void} done */
        const radio = (name, value, label, on, done) => {
            const input = element("input", { type: "radio", name, value });
            input.checked = on;
            input.addEventListener("change", done);
            return element("label", {}, input, label);
        };
        const colours = [
            radio("review-colours", "tissues", words.tissues, true, () => this.colour(false)),
            radio("review-colours", "deviation", words.deviation, false, () => this.colour(true)),
        ];
        const offset = element("input", { type: "range", min: "0", max: "1", step: "0.005", "aria-label": words["section-place"] });
        offset.disabled = true;
        offset.addEventListener("input", () => {
            if (this.section) this.section.offset = Number(offset.value);
            this.ask();
        });
        const sections = ["none", "x", "y", "z"].map((axis) =>
            radio("review-section", axis, words[`section-${axis}`], axis === "none", () => {
                offset.disabled = axis === "none";
                this.section = axis === "none" ? null : { axis, offset: this.shareOfMiddle(axis) };
                if (this.section) {
                    offset.value = String(this.section.offset);
                    this.camera = { ...this.camera, ...this.facing(axis) };
                }
                this.ask();
            }));
        /** @param {string} label @param {(isOn: boolean) => void} set */
        const shown = (label, set) => {
            const box = element("input", { type: "checkbox" });
            box.checked = true;
            box.addEventListener("change", () => {
                set(box.checked);
                this.ask();
            });
            return element("label", {}, box, label);
        };
        const bur = shown(words.bur, (isOn) => (this.isBur = isOn)), around = shown(words.around, (isOn) => (this.isAround = isOn));
        this.panel = element("div", { class: "review-panel" },
            group(words.views, ...views), ...(review.ideal ? [group(words.colours, ...colours)] : []), group(words.section, ...sections, offset),
            bur, ...(review.around.length ? [around] : []), element("p", { id: "review-help", class: "review-note" }, words.help));
        if (!this.picture) this.panel.hidden = true;
        this.legendOf_();
    }

    /** @param {boolean} isDeviation */
    colour(isDeviation) {
        this.isDeviation = isDeviation;
        this.legendOf_();
        this.ask();
    }

    legendOf_() {
        const { words, review } = this, deviation = review.text.deviation;
        /** @param {string} colour @param {string} text */
        const entry = (colour, text) => {
            const chip = element("span", { class: "chip", "aria-hidden": "true" });
            chip.style.background = colour;
            return element("li", {}, chip, text);
        };
        this.legend.replaceChildren(
            ...(this.isDeviation && deviation
                ? [0, 0.25, 0.5, 0.75, 1].map((share) => {
                      const mm = (2 * share - 1) * deviation.mostMm;
                      const text = mm === 0 ? words["as-ideal"] : (mm < 0 ? words["too-much"] : words["too-little"]).replace("{}", Math.abs(mm).toFixed(2));
                      return entry(deviation.scale[Math.round(share * (deviation.scale.length - 1))], text);
                  })
                : review.text.tissues.map(({ colour, name }) => entry(colour, name))));
    }

    lists_() {
        const { words, review } = this, { errors, moments } = review.text;
        /** @param {string} title @param {string} empty @param {any[]} rows */
        const list = (title, empty, rows) => [element("h3", {}, title), rows.length ? element("ol", {}, ...rows) : element("p", { class: "review-note" }, empty)];
        /** @param {number | undefined} timeS @param {Vec3 | undefined} placeMm @param {(Node | string)[]} inside */
        const row = (timeS, placeMm, ...inside) => {
            const button = element("button", { type: "button", class: "review-row" }, ...(timeS === undefined ? [] : [element("span", { class: "time" }, clock(timeS))]), ...inside);
            button.addEventListener("click", () => this.show(timeS, placeMm));
            return element("li", {}, button);
        };
        this.lists = element("div", { class: "review-lists" },
            ...(errors
                ? list(words.errors, words["no-errors"], errors.map((e) => row(e.timeS, e.placeMm, element("strong", {}, e.title), ` ${e.lost}`, element("span", { class: "detail" }, e.measured), element("span", { class: "detail" }, e.practise))))
                : []),
            ...list(words.moments, words["no-moments"], moments.map((m) => row(m.timeS, undefined, m.text))));
    }

    /**
     * To a moment and a place.
     * @param {number | undefined} timeS @param {Vec3 | undefined} placeMm none: where the bur is
     */
    show(timeS, placeMm) {
        this.play(false);
        this.go(timeS ?? this.timeS);
        const place = placeMm ?? this.review.poseAt(this.timeS).placeMm;
        this.markMm = place;
        // From where the bur came nearest: into a preparation, not through its wall.
        const { yawDeg, pitchDeg } = this.whence_(this.review.nearestPose(place));
        const isSteep = pitchDeg > 90 - 2 * kBesideDeg;
        this.camera = {
            ...this.camera,
            targetMm: /** @type {Vec3} */ ([...place]),
            distanceMm: this.standard("oblique").distanceMm * 0.6,
            yawDeg: isSteep ? this.camera.yawDeg : yawDeg + kBesideDeg,
            pitchDeg: isSteep ? 90 - kBesideDeg : pitchDeg + 10,
        };
        this.ask();
    }

    /**
     * How far along an axis the middle of the cut lies.
     * @param {string} axis
     */
    shareOfMiddle(axis) {
        const k = "xyz".indexOf(axis);
        return within((this.middleMm[k] - this.box.low[k]) / (this.box.high[k] - this.box.low[k]), 0, 1);
    }

    /**
     * An eye that sees the face of a section.
     * @param {string} axis
     */
    facing(axis) {
        const b = this.review.text.buccalSign;
        return axis === "x" ? { yawDeg: 10, pitchDeg: 20 } : axis === "y" ? { yawDeg: 90 * b + 10, pitchDeg: 20 } : { yawDeg: -90 * b, pitchDeg: 65 };
    }

    /** @returns {import("./draw.js").Plane | null} */
    plane() {
        if (!this.section) return null;
        const k = "xyz".indexOf(this.section.axis), sign = k === 1 ? this.review.text.buccalSign : 1;
        const at = this.box.low[k] + this.section.offset * (this.box.high[k] - this.box.low[k]);
        /** @type {Vec3} */
        const normal = [0, 0, 0];
        normal[k] = sign;
        return { normal, offsetMm: sign * at };
    }

    hands_() {
        const { canvas } = this;
        /** @type {Map<number, PointerEvent>} */
        const held = new Map();
        canvas.addEventListener("pointerdown", (/** @type {PointerEvent} */ e) => {
            canvas.setPointerCapture(e.pointerId);
            held.set(e.pointerId, e);
        });
        for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (/** @type {PointerEvent} */ e) => held.delete(e.pointerId));
        canvas.addEventListener("pointermove", (/** @type {PointerEvent} */ e) => {
            const last = held.get(e.pointerId);
            if (!last) return;
            const dx = e.clientX - last.clientX, dy = e.clientY - last.clientY;
            if (held.size === 2) {
                const other = [...held.values()].find((p) => p.pointerId !== e.pointerId);
                if (other) {
                    const was = Math.hypot(last.clientX - other.clientX, last.clientY - other.clientY);
                    this.zoom(was / Math.max(1, Math.hypot(e.clientX - other.clientX, e.clientY - other.clientY)));
                }
                this.pan(dx / 2, dy / 2);
            } else if (e.buttons & 6 || e.shiftKey) this.pan(dx, dy);
            else this.turn(-0.4 * dx, 0.4 * dy);
            held.set(e.pointerId, e);
        });
        canvas.addEventListener("contextmenu", (/** @type {Event} */ e) => e.preventDefault());
        canvas.addEventListener("wheel", (/** @type {WheelEvent} */ e) => {
            e.preventDefault();
            this.zoom(Math.exp(within(e.deltaY, -100, 100) * 0.002));
        }, { passive: false });
        canvas.addEventListener("keydown", (/** @type {KeyboardEvent} */ e) => {
            const pan = kPanShare * canvas.clientHeight, [dx, dy] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[e.key] ?? [0, 0];
            if (e.ctrlKey || e.altKey || e.metaKey) return;
            if (dx || dy) e.shiftKey ? this.pan(-dx * pan, -dy * pan) : this.turn(kTurnDeg * dx, -kTurnDeg * dy);
            else if (e.key === "+" || e.key === "=") this.zoom(1 / kZoom);
            else if (e.key === "-") this.zoom(kZoom);
            else if (e.key === "0" || e.key === "Home") this.camera = this.standard("oblique");
            else if (e.key === " ") this.play(!this.isPlaying);
            else return;
            e.preventDefault();
            this.ask();
        });
    }

    /** @param {number} yawDeg @param {number} pitchDeg */
    turn(yawDeg, pitchDeg) {
        const way = this.camera.isHanging ? -1 : 1;
        this.camera.yawDeg += way * yawDeg;
        this.camera.pitchDeg = within(this.camera.pitchDeg + way * pitchDeg, -89.9, 89.9);
        this.ask();
    }
    /** @param {number} dx of the picture's points @param {number} dy */
    pan(dx, dy) {
        const { right, up } = axesOf(this.camera), mm = (0.44 * this.camera.distanceMm) / Math.max(1, this.canvas.clientHeight);
        this.camera.targetMm = /** @type {Vec3} */ (this.camera.targetMm.map((t, k) => t - dx * mm * right[k] + dy * mm * up[k]));
        this.ask();
    }
    /** @param {number} factor over 1: farther off */
    zoom(factor) {
        const far = this.standard("oblique").distanceMm;
        this.camera.distanceMm = within(this.camera.distanceMm * factor, 0.12 * far, 4 * far);
        this.ask();
    }

    /** @param {boolean} on */
    play(on) {
        if (on && !this.isPlaying) {
            if (this.timeS >= this.review.text.durationS) this.go(0);
            this.isPlaying = true;
            let last = performance.now();
            const next = (/** @type {number} */ now) => {
                if (!this.isPlaying) return;
                const timeS = this.timeS + (this.speed * Math.max(0, now - last)) / 1000;
                last = Math.max(last, now);
                this.go(timeS);
                if (timeS >= this.review.text.durationS) this.play(false);
                else requestAnimationFrame(next);
            };
            requestAnimationFrame(next);
        } else if (!on) this.isPlaying = false;
        this.playButton.textContent = this.isPlaying ? `❚❚ ${this.words.pause}` : `▶ ${this.words.play}`;
    }

    /** @param {number} timeS */
    go(timeS) {
        const end = this.review.text.durationS;
        this.timeS = within(timeS, 0, end);
        const touched = this.tooth.seek(this.timeS);
        this.picture?.touch(touched);
        this.slider.value = String(this.timeS);
        this.slider.setAttribute("aria-valuetext", clock(this.timeS));
        this.clock.textContent = `${clock(this.timeS)} / ${clock(end)}`;
        const x = String(end > 0 ? (kWide * this.timeS) / end : 0);
        for (const line of this.heads) {
            line.setAttribute("x1", x);
            line.setAttribute("x2", x);
        }
        this.forceNow.textContent = `${this.review.forceAt(this.timeS).toFixed(2)} N`;
        this.depthNow.textContent = `${Math.max(0, this.review.poseAt(this.timeS).tipDepthMm).toFixed(2)} mm`;
        this.playButton.textContent ||= `▶ ${this.words.play}`;
        if (!this.picture && this.pictures.length) {
            const shown = this.pictures[indexAt(this.pictures.map((p) => p.timeS), this.timeS)];
            this.fallback.src = shown.picture.src;
            this.fallback.alt = shown.picture.alt;
            this.message.textContent = `${this.words["no-webgl"]} (${shown.picture.alt})`;
        }
        this.ask();
    }

    /** A drawing, soon. */
    ask() {
        if (this.isAsked || !this.picture) return;
        this.isAsked = true;
        requestAnimationFrame(() => {
            this.isAsked = false;
            this.draw();
        });
    }

    draw() {
        if (!this.picture) return;
        const { canvas } = this, scale = Math.min(window.devicePixelRatio || 1, 2);
        const width = Math.max(1, Math.round(canvas.clientWidth * scale)), height = Math.max(1, Math.round(canvas.clientHeight * scale));
        if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
        this.picture.draw({ camera: this.camera, plane: this.plane(), deviation: this.isDeviation, bur: this.isBur, around: !this.isAround ? "hidden" : this.markMm ? "faint" : "shown", timeS: this.timeS });
        const at = this.markMm && projected(matrixOf(this.camera, width / height), this.markMm);
        this.mark.hidden = !at;
        if (at) {
            this.mark.style.left = `${100 * at[0]}%`;
            this.mark.style.top = `${100 * at[1]}%`;
        }
    }
}
