// Discs with an outline and, if asked for, a mark that shows the angle.
//
// How it works: one instance a disc, one quad an instance, spanned here from the vertex index and
// one pixel larger than the disc. The fragment measures its distance to the disc's edge and turns
// it into the covered part of the pixel, so that edges are smooth without multisampling. Lengths
// are pixels, positions are relative to the middle of the picture, y up. `src/render/primitives.rs` holds
// the same formulas for the processor; change both.

struct Frame {
    // Middle of the picture in the render target, pixels, y down.
    centre: vec2<f32>,
    // Half of its width and height, pixels.
    half_size: vec2<f32>,
}

@group(0) @binding(0) var<uniform> frame: Frame;

struct Disc {
    @location(0) centre: vec2<f32>,
    // Radius, width of the outline, half the width of the mark.
    @location(1) sizes: vec3<f32>,
    // Cosine and sine of the angle.
    @location(2) direction: vec2<f32>,
    @location(3) fill: vec4<f32>,
    @location(4) outline: vec4<f32>,
}

struct Fragment {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat, either) centre: vec2<f32>,
    @location(1) @interpolate(flat, either) sizes: vec3<f32>,
    @location(2) @interpolate(flat, either) direction: vec2<f32>,
    @location(3) @interpolate(flat, either) fill: vec4<f32>,
    @location(4) @interpolate(flat, either) outline: vec4<f32>,
}

// A disc thinner than a pixel is drawn one pixel wide and fainter instead.
const LEAST_RADIUS: f32 = 0.5;

@vertex
fn vertex(@builtin(vertex_index) index: u32, disc: Disc) -> Fragment {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    let reach = max(disc.sizes.x, LEAST_RADIUS) + 1.0;
    let position = (disc.centre + corner * reach) / frame.half_size;
    return Fragment(
        vec4<f32>(position, 0.0, 1.0),
        disc.centre,
        disc.sizes,
        disc.direction,
        disc.fill,
        disc.outline,
    );
}

// Covered part of a pixel whose middle is `distance` outside an edge.
fn coverage(distance: f32) -> f32 {
    return clamp(0.5 - distance, 0.0, 1.0);
}

fn premultiplied(colour: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(colour.rgb * colour.a, colour.a);
}

@fragment
fn fragment(disc: Fragment) -> @location(0) vec4<f32> {
    let y_down = disc.position.xy - frame.centre;
    let offset = vec2<f32>(y_down.x, -y_down.y) - disc.centre;
    let distance = length(offset);

    let radius = max(disc.sizes.x, LEAST_RADIUS);
    let faint = min(disc.sizes.x / LEAST_RADIUS, 1.0);
    let whole = coverage(distance - radius) * faint * faint;
    let inner_radius = disc.sizes.x - disc.sizes.y;
    let inner = min(coverage(distance - inner_radius), whole);

    var marked = 0.0;
    if disc.sizes.z > 0.0 {
        let along = clamp(dot(offset, disc.direction), 0.0, max(inner_radius, 0.0));
        let half_width = max(disc.sizes.z, LEAST_RADIUS);
        let thin = min(disc.sizes.z / LEAST_RADIUS, 1.0);
        marked = coverage(length(offset - along * disc.direction) - half_width) * thin;
    }
    let outline = premultiplied(disc.outline);
    let inside = mix(premultiplied(disc.fill), outline, marked);
    return inside * inner + outline * (whole - inner);
}
