// SPDX-License-Identifier: Apache-2.0
/**
 * Draws a review's tooth and bur with WebGL2: from where, cut by which plane, in which colours. Knows no page.
 * @module
 */
import { kMiddle } from "./review.js";
import { chunkCounts, chunksOf, meshOf } from "./surface.js";

/**
 * @typedef {[number, number, number]} Vec3
 * @typedef {import("./review.js").Review} Review
 * @typedef {{targetMm: Vec3, yawDeg: number, pitchDeg: number, distanceMm: number, isHanging?: boolean}} Camera yaw about the tooth's axis, 0 from mesial; hanging: the crown is down
 * @typedef {{normal: Vec3, offsetMm: number}} Plane what lies beyond it is cut off
 * @typedef {{camera: Camera, plane: Plane | null, deviation: boolean, bur: boolean, around: "shown" | "faint" | "hidden", timeS: number}} Look
 */

const kTissues = 32;
/**
 * Darker than any enamel, so that its outline and its section stand out.
 * @type {[number, number, number]}
 */
const kBackground = [180 / 255, 190 / 255, 201 / 255];
const kFieldOfViewDeg = 25;
/** So many bricks of the distances go to the section one by one, more all at once. */
const kMostSingleBricks = 400;

const kVertexShader = `#version 300 es
in vec3 place;
in vec3 normal;
uniform mat4 model, camera;
out vec3 gridPlace, worldPlace, worldNormal;
void main() {
    vec4 world = model * vec4(place, 1.0);
    gridPlace = place;
    worldPlace = world.xyz;
    worldNormal = mat3(model) * normal;
    gl_Position = camera * world;
}`;

const kFragmentShader = `#version 300 es
precision highp float;
precision highp sampler3D;
precision highp usampler3D;
in vec3 gridPlace, worldPlace, worldNormal;
uniform int what;  // 0 tooth, 1 bur, 2 face of a section, 3 around the tooth
uniform vec3 own;  // colour of 3
uniform bool isFaint;  // of 3: every other point alone
uniform bool isCut, inDeviation;
uniform vec4 plane;  // of the world [mm]
uniform vec3 eye;
uniform vec3 nodes;
uniform sampler3D distances;
uniform usampler3D tissues;
uniform sampler3D ideal;
uniform sampler2D scale;
uniform vec3 colours[${kTissues}];
out vec4 colour;

// The tissue that weighs most among the eight nodes around.
vec3 tissueAt(vec3 p) {
    p = clamp(p, vec3(0.0), nodes - 1.001);
    ivec3 base = ivec3(p);
    vec3 f = p - vec3(base);
    uint id[8];
    float weight[8];
    bool isOne = true;
    for (int c = 0; c < 8; ++c) {
        ivec3 d = ivec3(c & 1, (c >> 1) & 1, c >> 2);
        id[c] = texelFetch(tissues, base + d, 0).r;
        vec3 w = mix(1.0 - f, f, vec3(d));
        weight[c] = w.x * w.y * w.z;
        isOne = isOne && id[c] == id[0];
    }
    if (isOne) return colours[min(id[0], ${kTissues - 1}u)];
    float most = -1.0;
    uint best = 0u;
    for (int c = 0; c < 8; ++c) {
        float sum = 0.0;
        for (int d = 0; d < 8; ++d) sum += id[d] == id[c] ? weight[d] : 0.0;
        if (sum > most && id[c] != 0u) { most = sum; best = id[c]; }
    }
    return colours[min(best, ${kTissues - 1}u)];
}
float at(sampler3D of, vec3 p) {
    return (texture(of, (p + 0.5) / nodes).r * 255.0 - ${kMiddle}.0) / 127.0;
}
void main() {
    if (isCut && dot(plane.xyz, worldPlace) > plane.w + (what == 2 ? 0.01 : 0.0)) discard;
    vec3 n = normalize(worldNormal), toEye = normalize(eye - worldPlace);
    if (dot(n, toEye) < 0.0) n = -n;
    vec3 base;
    if (what == 1) {
        base = vec3(0.62, 0.65, 0.70);
    } else if (what == 3) {
        if (isFaint && (int(gl_FragCoord.x) + int(gl_FragCoord.y)) % 2 == 0) discard;
        base = own;
    } else if (what == 2) {
        float inside = at(distances, gridPlace);
        if (inside > 0.0) discard;
        base = tissueAt(gridPlace);
        // A line every millimetre, along the axes that the plane does not stand across.
        vec3 width = fwidth(worldPlace), mm = abs(fract(worldPlace + 0.5) - 0.5) / max(width, vec3(1e-6));
        float line = 9.0;
        for (int k = 0; k < 3; ++k) line = width[k] > 1e-4 ? min(line, mm[k]) : line;
        base *= mix(0.86, 1.0, clamp(line - 0.3, 0.0, 1.0));
        base = mix(vec3(0.25, 0.27, 0.31), base, smoothstep(0.8, 1.8, abs(inside) / max(fwidth(inside), 1e-5)));
        if (inDeviation) {
            float off = at(ideal, gridPlace);
            base = mix(vec3(0.05, 0.2, 0.55), base, smoothstep(0.8, 1.8, abs(off) / max(fwidth(off), 1e-5)));
        }
        colour = vec4(base, 1.0);
        return;
    } else if (inDeviation) {
        base = texture(scale, vec2(at(ideal, gridPlace) * 0.5 + 0.5, 0.5)).rgb;
    } else {
        base = tissueAt(gridPlace - 0.6 * normalize(worldNormal));
    }
    vec3 light = normalize(toEye + vec3(0.25, 0.15, 0.55));
    float diffuse = max(dot(n, light), 0.0);
    float shine = pow(max(dot(reflect(-light, n), toEye), 0.0), 24.0);
    colour = vec4(base * (0.34 + 0.70 * diffuse) + (what == 1 ? 0.35 : 0.06) * shine, 1.0);
}`;

/** @param {number[]} a @param {number[]} b */
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
/** @param {Vec3} a @param {Vec3} b @returns {Vec3} */
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
/** @param {Vec3} a @returns {Vec3} */
const unit = (a) => {
    const length = Math.hypot(...a) || 1;
    return [a[0] / length, a[1] / length, a[2] / length];
};
/** @param {string} colour "#rrggbb" */
const shares = (colour) => [1, 3, 5].map((i) => parseInt(colour.slice(i, i + 2), 16) / 255);

/**
 * The eye's own axes.
 * @param {Camera} camera
 */
export function axesOf(camera) {
    const yaw = (camera.yawDeg * Math.PI) / 180, pitch = (camera.pitchDeg * Math.PI) / 180;
    /** @type {Vec3} */
    const back = [Math.cos(pitch) * Math.cos(yaw), Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch)];
    const side = camera.isHanging ? -1 : 1;
    /** @type {Vec3} */
    const right = [-side * Math.sin(yaw), side * Math.cos(yaw), 0];
    /** @type {Vec3} */
    const [x, y, z] = camera.targetMm, far = camera.distanceMm;
    /** @type {Vec3} */
    const eyeMm = [x + far * back[0], y + far * back[1], z + far * back[2]];
    return { back, right, up: cross(back, right), eyeMm };
}

/**
 * From the tooth to the picture, column by column.
 * @param {Camera} camera @param {number} aspect width by height
 */
export function matrixOf(camera, aspect) {
    const { back, right, up, eyeMm } = axesOf(camera);
    const near = camera.distanceMm * 0.1, far = camera.distanceMm + 60, f = 1 / Math.tan((kFieldOfViewDeg * Math.PI) / 360);
    // A high picture sees as much across as a square one.
    const fx = aspect < 1 ? f : f / aspect, fy = aspect < 1 ? f * aspect : f;
    const a = (far + near) / (near - far), b = (2 * far * near) / (near - far);
    const m = new Float32Array(16);
    for (let k = 0; k < 3; ++k) {
        m[4 * k] = fx * right[k];
        m[4 * k + 1] = fy * up[k];
        m[4 * k + 2] = a * back[k];
        m[4 * k + 3] = -back[k];
    }
    m[12] = -fx * dot(right, eyeMm);
    m[13] = -fy * dot(up, eyeMm);
    m[14] = -a * dot(back, eyeMm) + b;
    m[15] = dot(back, eyeMm);
    return m;
}

/**
 * Where a place lies in the picture, 0 to 1 from its upper left; null behind the eye.
 * @param {Float32Array} m @param {Vec3} p @returns {[number, number] | null}
 */
export function projected(m, p) {
    const [x, y, , w] = [0, 1, 2, 3].map((r) => m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r]);
    return w > 0 ? [0.5 + (0.5 * x) / w, 0.5 - (0.5 * y) / w] : null;
}

/** @typedef {{array: WebGLVertexArrayObject, buffers: WebGLBuffer[], count: number}} Drawn */

export class ToothPicture {
    /**
     * @param {HTMLCanvasElement} canvas @param {Review} review
     * @param {Uint8Array} distance of the tooth: read whenever touch() has told what changed in it
     */
    constructor(canvas, review, distance) {
        const gl = canvas.getContext("webgl2", { antialias: true, alpha: false, preserveDrawingBuffer: true });
        if (!gl) throw new Error("no WebGL2");
        if (Math.max(...review.text.grid.nodes) > gl.getParameter(gl.MAX_3D_TEXTURE_SIZE)) throw new Error("the tooth is too large for this browser's WebGL2");
        this.canvas = canvas;
        this.gl = gl;
        this.review = review;
        this.distance = distance;
        this.program = this.linked_();
        /** @type {Record<string, WebGLUniformLocation | null>} */
        this.at = {};
        for (const name of ["model", "camera", "what", "isCut", "inDeviation", "plane", "eye", "nodes", "distances", "tissues", "ideal", "scale", "colours", "own", "isFaint"])
            this.at[name] = gl.getUniformLocation(this.program, name);
        /** @type {Map<number, Drawn>} */
        this.chunks = new Map();
        /** @type {{drawn: Drawn, colour: number[]}[] | null} made when it is first seen */
        this.around = null;
        /** Chunks to be made anew, bricks that the section has yet to hear of. */
        this.stale = new Set(Array(chunkCounts(review.text.grid.nodes).reduce((a, b) => a * b)).keys());
        /** @type {Set<number>} */
        this.unsent = new Set();
        /** @type {Map<object, Drawn>} */
        this.burs = new Map();
        this.textures_();
    }

    /** @param {Iterable<number>} bricks that are others now */
    touch(bricks) {
        for (const chunk of chunksOf(bricks, this.review.text.grid)) this.stale.add(chunk);
        for (const brick of bricks) this.unsent.add(brick);
    }

    linked_() {
        const { gl } = this, program = /** @type {WebGLProgram} */ (gl.createProgram());
        for (const [kind, source] of /** @type {[number, string][]} */ ([[gl.VERTEX_SHADER, kVertexShader], [gl.FRAGMENT_SHADER, kFragmentShader]])) {
            const shader = /** @type {WebGLShader} */ (gl.createShader(kind));
            gl.shaderSource(shader, source);
            gl.compileShader(shader);
            gl.attachShader(program, shader);
        }
        gl.bindAttribLocation(program, 0, "place");
        gl.bindAttribLocation(program, 1, "normal");
        gl.linkProgram(program);
        if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(`WebGL2: ${gl.getProgramInfoLog(program)}`);
        return program;
    }

    textures_() {
        const { gl, review } = this, [nx, ny, nz] = review.text.grid.nodes;
        gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
        /** @param {number} unit_ @param {number} inside @param {number} format @param {Uint8Array} bytes @param {number} filter */
        const volume = (unit_, inside, format, bytes, filter) => {
            gl.activeTexture(gl.TEXTURE0 + unit_);
            gl.bindTexture(gl.TEXTURE_3D, gl.createTexture());
            gl.texImage3D(gl.TEXTURE_3D, 0, inside, nx, ny, nz, 0, format, gl.UNSIGNED_BYTE, bytes);
            for (const side of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R]) gl.texParameteri(gl.TEXTURE_3D, side, gl.CLAMP_TO_EDGE);
            for (const which of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_3D, which, filter);
        };
        volume(0, gl.R8, gl.RED, this.distance, gl.LINEAR);
        volume(1, gl.R8UI, gl.RED_INTEGER, review.tissue, gl.NEAREST);
        if (review.ideal) volume(2, gl.R8, gl.RED, review.ideal, gl.LINEAR);
        gl.activeTexture(gl.TEXTURE3);
        gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
        const scale = (review.text.deviation?.scale ?? ["#ffffff"]).flatMap((colour) => [...shares(colour), 1].map((v) => Math.round(255 * v)));
        gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, scale.length / 4, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, Uint8Array.from(scale));
        for (const side of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, side, gl.CLAMP_TO_EDGE);
        for (const which of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, which, gl.LINEAR);
    }

    /** @param {Float32Array} places @param {Float32Array} normals @param {Uint16Array} triangles @returns {Drawn} */
    uploaded_(places, normals, triangles) {
        const { gl } = this, array = /** @type {WebGLVertexArrayObject} */ (gl.createVertexArray());
        gl.bindVertexArray(array);
        const buffers = [places, normals].map((data, attribute) => {
            const buffer = /** @type {WebGLBuffer} */ (gl.createBuffer());
            gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
            gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
            gl.enableVertexAttribArray(attribute);
            gl.vertexAttribPointer(attribute, 3, gl.FLOAT, false, 0, 0);
            return buffer;
        });
        const index = /** @type {WebGLBuffer} */ (gl.createBuffer());
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, index);
        gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW);
        gl.bindVertexArray(null);
        return { array, buffers: [...buffers, index], count: triangles.length };
    }

    /** @param {Drawn | undefined} drawn */
    dropped_(drawn) {
        if (!drawn) return;
        this.gl.deleteVertexArray(drawn.array);
        for (const buffer of drawn.buffers) this.gl.deleteBuffer(buffer);
    }

    mesh_() {
        const nodes = this.review.text.grid.nodes, [cx, cy] = chunkCounts(nodes);
        for (const chunk of this.stale) {
            this.dropped_(this.chunks.get(chunk));
            this.chunks.delete(chunk);
            const mesh = meshOf(this.distance, nodes, [chunk % cx, Math.floor(chunk / cx) % cy, Math.floor(chunk / (cx * cy))]);
            if (mesh && mesh.triangles.length) this.chunks.set(chunk, this.uploaded_(mesh.positions, mesh.normals, mesh.triangles));
        }
        this.stale.clear();
    }

    send_() {
        const { gl, review, unsent } = this, { nodes: [nx, ny, nz], bricks: [bx, by], brickEdge: edge } = review.text.grid;
        gl.activeTexture(gl.TEXTURE0);
        if (unsent.size > kMostSingleBricks) {
            gl.texSubImage3D(gl.TEXTURE_3D, 0, 0, 0, 0, nx, ny, nz, gl.RED, gl.UNSIGNED_BYTE, this.distance);
        } else {
            gl.pixelStorei(gl.UNPACK_ROW_LENGTH, nx);
            gl.pixelStorei(gl.UNPACK_IMAGE_HEIGHT, ny);
            for (const brick of unsent) {
                const x = (brick % bx) * edge, y = (Math.floor(brick / bx) % by) * edge, z = Math.floor(brick / (bx * by)) * edge;
                gl.texSubImage3D(gl.TEXTURE_3D, 0, x, y, z, edge, edge, edge, gl.RED, gl.UNSIGNED_BYTE, this.distance, x + nx * (y + ny * z));
            }
            gl.pixelStorei(gl.UNPACK_ROW_LENGTH, 0);
            gl.pixelStorei(gl.UNPACK_IMAGE_HEIGHT, 0);
        }
        unsent.clear();
    }

    /**
     * The bur's outline, turned.
     * @param {import("./review.js").Bur} bur @returns {Drawn}
     */
    bur_(bur) {
        const known = this.burs.get(bur);
        if (known) return known;
        const around = 32, outline = bur.outlineMm, count = outline.length;
        /** @type {number[]} */
        const places = [], normals = [], triangles = [];
        for (let i = 0; i < count; ++i) {
            const [r0, z0] = outline[Math.max(i - 1, 0)], [r1, z1] = outline[Math.min(i + 1, count - 1)];
            const length = Math.hypot(z1 - z0, r1 - r0) || 1, nr = (z1 - z0) / length, nz = (r0 - r1) / length;
            for (let j = 0; j < around; ++j) {
                const c = Math.cos((2 * Math.PI * j) / around), s = Math.sin((2 * Math.PI * j) / around);
                places.push(outline[i][0] * c, outline[i][0] * s, outline[i][1]);
                normals.push(nr * c, nr * s, nz);
                const a = i * around + j, b = i * around + ((j + 1) % around);
                if (i + 1 < count) triangles.push(a, b, b + around, a, b + around, a + around);
            }
        }
        const drawn = this.uploaded_(Float32Array.from(places), Float32Array.from(normals), Uint16Array.from(triangles));
        this.burs.set(bur, drawn);
        return drawn;
    }

    /**
     * The middle of the tooth's part that the plane goes through, as a square in it.
     * @param {Plane} plane @returns {Drawn}
     */
    face_(plane) {
        const { originMm, voxelMm, nodes } = this.review.text.grid;
        const size = nodes.map((n) => (n - 1) * voxelMm), middle = originMm.map((o, k) => o + size[k] / 2);
        const reach = Math.hypot(...size) / 2, n = unit(plane.normal);
        const u = unit(cross(n, Math.abs(n[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0])), v = cross(n, u);
        const off = plane.offsetMm - dot(n, middle);
        /** @type {number[]} */
        const places = [], normals = [];
        for (const [a, b] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
            for (let k = 0; k < 3; ++k) places.push((middle[k] + off * n[k] + reach * (a * u[k] + b * v[k]) - originMm[k]) / voxelMm);
            normals.push(...n);
        }
        return this.uploaded_(Float32Array.from(places), Float32Array.from(normals), Uint16Array.from([0, 1, 2, 0, 2, 3]));
    }

    /** @param {Look} look */
    draw(look) {
        const { gl, canvas, review, at } = this;
        if (gl.isContextLost()) return;
        this.mesh_();
        if (look.plane && this.unsent.size) this.send_();
        const { originMm, voxelMm, nodes } = review.text.grid;
        gl.viewport(0, 0, canvas.width, canvas.height);
        gl.clearColor(...kBackground, 1);
        gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
        gl.enable(gl.DEPTH_TEST);
        gl.useProgram(this.program);
        gl.uniformMatrix4fv(at.camera, false, matrixOf(look.camera, canvas.width / canvas.height));
        gl.uniformMatrix4fv(at.model, false, [voxelMm, 0, 0, 0, 0, voxelMm, 0, 0, 0, 0, voxelMm, 0, ...originMm, 1]);
        gl.uniform3fv(at.eye, axesOf(look.camera).eyeMm);
        gl.uniform3fv(at.nodes, nodes);
        ["distances", "tissues", "ideal", "scale"].forEach((name, unit_) => gl.uniform1i(at[name], name === "ideal" && !review.ideal ? 0 : unit_));
        const colours = new Float32Array(3 * kTissues).fill(0.8);
        for (const { id, colour } of review.text.tissues) if (id < kTissues) colours.set(shares(colour), 3 * id);
        gl.uniform3fv(at.colours, colours);
        gl.uniform1i(at.inDeviation, Number(look.deviation && review.ideal !== null));
        gl.uniform1i(at.isCut, Number(look.plane !== null));
        if (look.plane) gl.uniform4fv(at.plane, [...look.plane.normal, look.plane.offsetMm]);
        gl.uniform1i(at.what, 0);
        for (const chunk of this.chunks.values()) this.show_(chunk);
        if (look.plane) {
            const face = this.face_(look.plane);
            gl.uniform1i(at.what, 2);
            this.show_(face);
            this.dropped_(face);
        }
        if (look.around !== "hidden") {
            gl.uniform1i(at.what, 3);
            gl.uniform1i(at.isFaint, Number(look.around === "faint"));
            gl.uniformMatrix4fv(at.model, false, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
            this.around ??= review.around.map((part) => ({ drawn: this.uploaded_(part.places, part.normals, part.triangles), colour: shares(part.colour) }));
            for (const { drawn, colour } of this.around) {
                gl.uniform3fv(at.own, colour);
                this.show_(drawn);
            }
        }
        if (look.bur) {
            const { placeMm: p, turn: [w, x, y, z] } = review.poseAt(look.timeS);
            gl.uniform1i(at.isCut, 0);
            gl.uniform1i(at.what, 1);
            gl.uniformMatrix4fv(at.model, false, [
                1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y), 0,
                2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x), 0,
                2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y), 0, ...p, 1]);
            this.show_(this.bur_(review.burAt(look.timeS)));
        }
        gl.bindVertexArray(null);
    }

    /** @param {Drawn} drawn */
    show_(drawn) {
        this.gl.bindVertexArray(drawn.array);
        this.gl.drawElements(this.gl.TRIANGLES, drawn.count, this.gl.UNSIGNED_SHORT, 0);
    }
}
