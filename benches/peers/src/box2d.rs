//! The engine Box2D v3, through the crate boxdd, which includes the C source.
//!
//! Box2D's slop (overlap that it does not push out) is 0.005 of its length unit, and the same for the whole program. To
//! set the slop, this benchmark scales the world: it multiplies lengths and g by one factor and leaves times unchanged.

use boxdd::{
    BodyBuilder, BodyId, BodyType, Foundation, Position, ShapeDef, SurfaceMaterial, Vec2, World,
    WorldBuilder, shapes,
};

use crate::engine::{Engine, SLOP_IN_DIAMETERS, Setting};
use crate::pile::{AREAL_DENSITY, GRAVITY, Pile};

/// Box2D's slop, in Box2D's length unit.
const SLOP: f64 = 0.005;

pub struct Box2d {
    world: World,
    grains: Vec<BodyId>,
    /// Number of Box2D length units per metre.
    scale: f64,
    setting: Setting,
}

impl Box2d {
    pub fn new(pile: &Pile, setting: Setting) -> boxdd::Result<Self> {
        let scale = SLOP / (SLOP_IN_DIAMETERS * pile.diameter());
        let foundation = Foundation::initialize_default()?;
        let world_def = WorldBuilder::from(foundation.world_def())
            .gravity(Vec2::new(0.0, (-GRAVITY * scale) as f32))
            .contact_hertz(setting.contact_hertz)
            .restitution_threshold(0.0)
            // This limit is faster than any body of the pile, so it does not limit the speed at which overlap is pushed
            // out.
            .contact_speed((10.0 * scale) as f32)
            .maximum_linear_speed((100.0 * scale) as f32)
            .enable_sleep(false)
            .enable_continuous(false)
            .build()?;
        let mut world = foundation.create_world(world_def)?;
        let [friction, restitution] = pile.friction_and_restitution();
        let material =
            SurfaceMaterial::new().with_friction(friction)?.with_restitution(restitution)?;
        let shape = ShapeDef::builder()
            .material(material)
            .density((AREAL_DENSITY / (scale * scale)) as f32)
            .build()?;
        let place = |x: f64, y: f64| Position::new((x * scale) as f32, (y * scale) as f32);
        let body = || BodyBuilder::from(foundation.body_def());
        for disc in &pile.base {
            let body =
                body().body_type(BodyType::Static).position(place(disc.x, disc.y)).build()?;
            let id = world.create_body(body)?;
            let circle = shapes::circle(Vec2::ZERO, (disc.radius * scale) as f32)?;
            world.body(id)?.create_circle(&shape, &circle)?;
        }
        let mut grains = Vec::with_capacity(pile.grains.len());
        for disc in &pile.grains {
            let body =
                body().body_type(BodyType::Dynamic).position(place(disc.x, disc.y)).build()?;
            let id = world.create_body(body)?;
            let circle = shapes::circle(Vec2::ZERO, (disc.radius * scale) as f32)?;
            world.body(id)?.create_circle(&shape, &circle)?;
            grains.push(id);
        }
        Ok(Self { world, grains, scale, setting })
    }
}

impl Engine for Box2d {
    fn step(&mut self) {
        let Setting { time_step_secs, substeps, .. } = self.setting;
        // Fails only if the step is not a finite number, which cannot happen here.
        let events = self.world.step(time_step_secs as f32, substeps as i32);
        drop(events.expect("a proper step"));
    }

    fn positions(&mut self) -> Vec<[f64; 2]> {
        let place = |id: &BodyId| {
            // The body belongs to this world and is never removed.
            let at = self.world.body(*id).and_then(|body| body.position()).expect("a body");
            [f64::from(at.x) / self.scale, f64::from(at.y) / self.scale]
        };
        self.grains.iter().map(place).collect()
    }
}
