// The engine's own passes: a G-buffer, and the light with umbra4's visibility.

struct View {
    view_projection: mat4x4f,
    unproject: mat4x4f,
    lamp: array<vec4f, 3>,
    eye: vec4f,
}

struct Instance {
    world: mat4x4f,
    colour: vec4f,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> instances: array<Instance>;

struct Surface {
    @builtin(position) position: vec4f,
    @location(0) normal: vec3f,
    @location(1) colour: vec3f,
}

@vertex
fn surface(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @builtin(instance_index) index: u32,
) -> Surface {
    let instance = instances[index];
    let world = instance.world * vec4f(position, 1.0);
    let turned = (instance.world * vec4f(normal, 0.0)).xyz;
    return Surface(view.view_projection * world, turned, instance.colour.rgb);
}

struct Pixel {
    @location(0) normal: vec4f,
    @location(1) colour: vec4f,
}

@fragment
fn gbuffer(in: Surface) -> Pixel {
    return Pixel(vec4f(normalize(in.normal), 0.0), vec4f(in.colour, 1.0));
}

@group(1) @binding(0) var depths: texture_depth_2d;
@group(1) @binding(1) var normals: texture_2d<f32>;
@group(1) @binding(2) var colours: texture_2d<f32>;
@group(1) @binding(3) var visibility: texture_2d<f32>;

@vertex
fn everywhere(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

// Light of a Lambertian rectangle on a point, by a few of its points; its shadows are umbra4's.
fn irradiance(p: vec3f, n: vec3f) -> f32 {
    let down = normalize(cross(view.lamp[1].xyz, view.lamp[2].xyz));
    let area = length(cross(view.lamp[1].xyz, view.lamp[2].xyz));
    var sum = 0.0;
    for (var k = 0u; k < 16u; k++) {
        let u = (f32(k & 3u) + 0.5) / 4.0;
        let v = (f32(k >> 2u) + 0.5) / 4.0;
        let d = view.lamp[0].xyz + u * view.lamp[1].xyz + v * view.lamp[2].xyz - p;
        let r2 = dot(d, d);
        sum += max(dot(n, d), 0.0) * max(-dot(down, d), 0.0) / (r2 * r2);
    }
    return sum * area / 16.0;
}

@fragment
fn light(@builtin(position) place: vec4f) -> @location(0) vec4f {
    let texel = vec2u(place.xy);
    let depth = textureLoad(depths, texel, 0);
    if depth == 0.0 {
        return vec4f(0.55, 0.65, 0.8, 1.0);
    }
    let size = vec2f(textureDimensions(depths));
    let clip = vec4f(2.0 * place.x / size.x - 1.0, 1.0 - 2.0 * place.y / size.y, depth, 1.0);
    let world = view.unproject * clip;
    let n = textureLoad(normals, texel, 0).xyz;
    let colour = textureLoad(colours, texel, 0).rgb;
    let lit = textureLoad(visibility, texel, 0).r;
    let sky = 0.16 + 0.08 * n.y;
    let linear = colour * (3.2 * lit * irradiance(world.xyz / world.w, n) + sky);
    return vec4f(pow(linear, vec3f(1.0 / 2.2)), 1.0);
}
