// Shadow rays through a hierarchy of four children a node: a thread a ray, any hit ends it.
// `const STACK`, the depth of the hierarchy, is put before this text.

struct Work {
    // Receivers of this dispatch.
    first: u32,
    end: u32,
    // The light's samples.
    columns: u32,
    rows: u32,
    // A point of the light, and where it shines; a receiver behind it has all samples blocked.
    point: vec3f,
    // Words of a row of a mask.
    words: u32,
    normal: vec3f,
    // Workgroups along the y axis.
    layer: u32,
}

@group(0) @binding(0) var<uniform> work: Work;
// Of every node: lower and upper x, y, z of its four children.
@group(0) @binding(1) var<storage, read> boxes: array<vec4f>;
// Of every node: its four children.
@group(0) @binding(2) var<storage, read> children: array<u32>;
// Of every triangle: a corner, and the two edges from it.
@group(0) @binding(3) var<storage, read> triangles: array<vec4f>;
@group(0) @binding(4) var<storage, read> receivers: array<vec4f>;
// Row by row.
@group(0) @binding(5) var<storage, read> samples: array<vec4f>;
// Lit samples of every receiver, or masks.
@group(0) @binding(6) var<storage, read_write> results: array<atomic<u32>>;

// Edge of the block of samples that a workgroup shoots at.
const BLOCK = 8u;
// Bits of a child: whether it is a leaf, then its number of triangles, then the first of them.
const LEAF = 0x80000000u;
const COUNT_SHIFT = 27u;
const FIRST_MASK = 0x07ffffffu;
// Children of a node, as bits of an entry of the stack.
const SLOT_BITS = 4u;
const SLOTS = 15u;
// Shortest component of a direction that boxes are entered with: its reciprocal is finite.
const SHORTEST = 1e-20;
// Widens boxes by what rounding may have taken from them.
const WIDER = 1.0000005;

struct Ray {
    origin: vec3f,
    // To the sample: it ends at 1.
    direction: vec3f,
    inverse: vec3f,
    // Which plane of a box the ray meets first on each axis, 0 or 1.
    near: vec3u,
}

fn ray_to(sample: vec3f, origin: vec3f) -> Ray {
    let direction = sample - origin;
    let short = abs(direction) < vec3f(SHORTEST);
    let inverse = 1.0 / select(direction, vec3f(SHORTEST), short);
    return Ray(origin, direction, inverse, select(vec3u(0u), vec3u(1u), inverse < vec3f(0.0)));
}

// The children of a node whose boxes the ray enters, as bits.
fn entered(node: u32, ray: Ray) -> u32 {
    let at = node * 6u;
    let near = ray.near;
    let near_x = (boxes[at + near.x] - ray.origin.x) * ray.inverse.x;
    let near_y = (boxes[at + 2u + near.y] - ray.origin.y) * ray.inverse.y;
    let near_z = (boxes[at + 4u + near.z] - ray.origin.z) * ray.inverse.z;
    let far_x = (boxes[at + 1u - near.x] - ray.origin.x) * ray.inverse.x;
    let far_y = (boxes[at + 3u - near.y] - ray.origin.y) * ray.inverse.y;
    let far_z = (boxes[at + 5u - near.z] - ray.origin.z) * ray.inverse.z;
    let enter = max(max(near_x, near_y), max(near_z, vec4f(0.0)));
    let leave = min(min(far_x, far_y), min(far_z, vec4f(1.0)));
    let bits = select(vec4u(0u), vec4u(1u, 2u, 4u, 8u), enter <= leave * WIDER);
    return bits.x | bits.y | bits.z | bits.w;
}

// Möller and Trumbore's test, without the division.
fn hits(triangle: u32, ray: Ray) -> bool {
    let corner = triangles[triangle * 3u].xyz;
    let edge_1 = triangles[triangle * 3u + 1u].xyz;
    let edge_2 = triangles[triangle * 3u + 2u].xyz;
    let p = cross(ray.direction, edge_2);
    let determinant = dot(edge_1, p);
    let side = sign(determinant);
    let from_corner = ray.origin - corner;
    let u = dot(from_corner, p) * side;
    let q = cross(from_corner, edge_1);
    let v = dot(ray.direction, q) * side;
    let t = dot(edge_2, q) * side;
    let whole = abs(determinant);
    return u >= 0.0 && v >= 0.0 && u + v <= whole && t > 0.0 && t < whole;
}

fn blocked(ray: Ray) -> bool {
    // Nodes on the way to this one, with the children that are still to be visited.
    var stack: array<u32, STACK>;
    var height = 0u;
    var node = 0u;
    var open = entered(node, ray);
    loop {
        if open == 0u {
            if height == 0u {
                break;
            }
            height -= 1u;
            node = stack[height] >> SLOT_BITS;
            open = stack[height] & SLOTS;
        }
        let child = children[node * 4u + firstTrailingBit(open)];
        open &= open - 1u;
        if (child & LEAF) != 0u {
            let first = child & FIRST_MASK;
            let end = first + ((child & ~LEAF) >> COUNT_SHIFT);
            for (var triangle = first; triangle < end; triangle++) {
                if hits(triangle, ray) {
                    return true;
                }
            }
        } else {
            if open != 0u {
                stack[height] = node << SLOT_BITS | open;
                height += 1u;
            }
            node = child;
            open = entered(node, ray);
        }
    }
    return false;
}

// The receiver of a workgroup.
fn receiver_of(group: vec3u) -> u32 {
    return work.first + group.z * work.layer + group.y;
}

// Column and row of the first sample of a workgroup.
fn block_of(group: vec3u) -> vec2u {
    let blocks = (work.columns + BLOCK - 1u) / BLOCK;
    return vec2u(group.x % blocks, group.x / blocks) * BLOCK;
}

fn is_there(receiver: u32, sample: vec2u) -> bool {
    return receiver < work.end && sample.x < work.columns && sample.y < work.rows;
}

fn is_blocked(receiver: u32, sample: vec2u) -> bool {
    let origin = receivers[receiver].xyz;
    if dot(work.normal, origin - work.point) <= 0.0 {
        return true;
    }
    return blocked(ray_to(samples[sample.y * work.columns + sample.x].xyz, origin));
}

var<workgroup> lit: atomic<u32>;

@compute @workgroup_size(BLOCK, BLOCK)
fn count_lit(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_id) local: vec3u,
    @builtin(local_invocation_index) thread: u32,
) {
    let receiver = receiver_of(group);
    let sample = block_of(group) + local.xy;
    if is_there(receiver, sample) && !is_blocked(receiver, sample) {
        atomicAdd(&lit, 1u);
    }
    workgroupBarrier();
    if thread == 0u && receiver < work.end {
        atomicAdd(&results[receiver], atomicLoad(&lit));
    }
}

var<workgroup> rows: array<atomic<u32>, BLOCK>;

@compute @workgroup_size(BLOCK, BLOCK)
fn write_masks(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let receiver = receiver_of(group);
    let block = block_of(group);
    let sample = block + local.xy;
    if is_there(receiver, sample) && is_blocked(receiver, sample) {
        atomicOr(&rows[local.y], 1u << local.x);
    }
    workgroupBarrier();
    if local.x == 0u && is_there(receiver, sample) {
        let word = (receiver * work.rows + sample.y) * work.words + block.x / 32u;
        atomicOr(&results[word], atomicLoad(&rows[local.y]) << (block.x % 32u));
    }
}
