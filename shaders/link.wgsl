// Links: straight strokes with round ends, for force chains, walls and bars.
//
// How it works: one instance a link, one quad an instance, spanned here from the vertex index along
// the link and one pixel larger than it. The fragment measures its distance to the segment and turns
// it into the covered part of the pixel. Lengths are pixels, positions are relative to the middle of
// the picture, y up. `src/render/primitives.rs` holds the same formulas for the processor; change both.

struct Frame {
    // Middle of the picture in the render target, pixels, y down.
    centre: vec2<f32>,
    // Half of its width and height, pixels.
    half_size: vec2<f32>,
}

@group(0) @binding(0) var<uniform> frame: Frame;

struct Link {
    @location(0) start: vec2<f32>,
    @location(1) end: vec2<f32>,
    @location(2) half_width: f32,
    @location(3) colour: vec4<f32>,
}

struct Fragment {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat, either) start: vec2<f32>,
    @location(1) @interpolate(flat, either) end: vec2<f32>,
    @location(2) @interpolate(flat, either) half_width: f32,
    @location(3) @interpolate(flat, either) colour: vec4<f32>,
}

// A link thinner than a pixel is drawn one pixel wide and fainter instead.
const LEAST_HALF_WIDTH: f32 = 0.5;

@vertex
fn vertex(@builtin(vertex_index) index: u32, link: Link) -> Fragment {
    let across_sign = f32(index & 1u) * 2.0 - 1.0;
    let at_end = (index >> 1u) == 1u;
    let span = link.end - link.start;
    let span_length = length(span);
    // A link without length still has a direction to span its quad along.
    var along = vec2<f32>(1.0, 0.0);
    if span_length > 0.0 {
        along = span / span_length;
    }
    let across = vec2<f32>(-along.y, along.x);
    let reach = max(link.half_width, LEAST_HALF_WIDTH) + 1.0;
    let corner = select(link.start - along * reach, link.end + along * reach, at_end);
    let position = (corner + across * (across_sign * reach)) / frame.half_size;
    return Fragment(
        vec4<f32>(position, 0.0, 1.0),
        link.start,
        link.end,
        link.half_width,
        link.colour,
    );
}

@fragment
fn fragment(link: Fragment) -> @location(0) vec4<f32> {
    let y_down = link.position.xy - frame.centre;
    let offset = vec2<f32>(y_down.x, -y_down.y) - link.start;
    let span = link.end - link.start;
    let squared = dot(span, span);
    var part = 0.0;
    if squared > 0.0 {
        part = clamp(dot(offset, span) / squared, 0.0, 1.0);
    }
    let distance = length(offset - span * part);

    let half_width = max(link.half_width, LEAST_HALF_WIDTH);
    let faint = min(link.half_width / LEAST_HALF_WIDTH, 1.0);
    let covered = clamp(0.5 - (distance - half_width), 0.0, 1.0) * faint * link.colour.a;
    return vec4<f32>(link.colour.rgb * covered, covered);
}
