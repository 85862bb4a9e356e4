//! `AsperityBody`: what rings, and what of it is touched.

use crate::res_files::ResFiles;
use crate::surface::{AsperitySurface, table_of, written};
use crate::world::{AsperityWorld, BODIES};
use godot::classes::INode3D;
use godot::prelude::*;
use toml::Value;

/// A body that rings, as the child of a physics body, and the surface that a finger touches on it.
/// It joins the world when it is ready and leaves it with the tree.
#[derive(GodotClass)]
#[class(init, base = Node3D)]
pub struct AsperityBody {
    /// A stock shape: "bar", "tube", "ring", "plate", "disc", "bowl", "block", "box", "can",
    /// "bottle", "pan", "barrel" or "door"; empty: `modes_file` or `table` says, or it is silent.
    #[export]
    #[init(val = "plate".into())]
    stock: GString,
    /// Longest side or diameter of the stock shape, m.
    #[export]
    #[init(val = 0.3)]
    size_m: f64,
    /// A material of the engine's, "steel" or "wood" for example.
    #[export]
    #[init(val = "steel".into())]
    material: GString,
    /// A modes file (`*.modes.json`), in the place of the stock shape.
    #[export(file = "*.json")]
    modes_file: GString,
    /// Gain, linear, 0 to 1000.
    #[export]
    #[init(val = 1.0)]
    gain: f64,
    /// Gain of blows relative to strokes, linear, 0 to 1000; 1: as mechanics says. Below 0: as
    /// `table` says, or as the world's scene file has it.
    #[export]
    #[init(val = -1.0)]
    strike_gain: f64,
    /// Time within which a blow no stronger than the one before is dropped, s, 0 to 60; 0 drops
    /// none.
    #[export]
    least_time_s: f64,
    /// Audio bus of the world, from 0.
    #[export]
    bus: i64,
    /// Further keys of a scene file's [[body]], TOML. The fields above count more.
    #[export(multiline)]
    table: GString,
    /// Surface that is touched; none: it can only be struck.
    #[export]
    surface: Option<Gd<AsperitySurface>>,
    world: Option<Gd<AsperityWorld>>,
    /// Which of the world's engines the ids belong to.
    build: u64,
    body_id: i64,
    surface_id: i64,
    base: Base<Node3D>,
}

#[godot_api]
impl INode3D for AsperityBody {
    fn ready(&mut self) {
        self.base_mut().add_to_group(BODIES);
        self.join();
    }

    fn exit_tree(&mut self) {
        let (body, surface) = (std::mem::take(&mut self.body_id), std::mem::take(&mut self.surface_id));
        // Ready is called again when it comes back.
        self.base_mut().request_ready();
        // A world that is freed with the scene has taken everything along.
        let Some(mut world) = self.world.take().filter(Gd::is_instance_valid) else { return };
        let mut held = world.bind_mut();
        if held.builds() == self.build {
            held.leave(body, surface);
        }
    }
}

#[godot_api]
impl AsperityBody {
    /// The body's id in its world; 0: it is in none, or its world was freed.
    #[func]
    fn body_id(&self) -> i64 {
        if self.has_world() { self.body_id } else { 0 }
    }

    /// The id of its surface; 0: it has none, or its world was freed.
    #[func]
    pub(crate) fn surface_id(&self) -> i64 {
        if self.has_world() { self.surface_id } else { 0 }
    }
}

impl AsperityBody {
    /// Its world, while that lives.
    pub(crate) fn world(&self) -> Option<Gd<AsperityWorld>> {
        self.world.as_ref().filter(|world| world.is_instance_valid()).cloned()
    }

    fn has_world(&self) -> bool {
        self.world.as_ref().is_some_and(Gd::is_instance_valid)
    }

    /// Place of a mesh's uv on the maps of its surface.
    pub(crate) fn on_maps(&self, uv: Vector2) -> Vector2 {
        self.surface.as_ref().map_or(uv, |surface| surface.bind().on_maps(uv))
    }

    /// Place in metres as one on the maps of its surface.
    pub(crate) fn in_spans(&self, place_m: Vector2) -> Vector2 {
        self.surface.as_ref().map_or(place_m, |surface| surface.bind().in_spans(place_m))
    }

    fn join(&mut self) {
        let Some(tree) = self.base().is_inside_tree().then(|| self.base().get_tree()) else { return };
        let Some(mut world) = AsperityWorld::of(&tree) else {
            godot_error!("AsperityBody: there is no AsperityWorld in the tree; add one");
            return;
        };
        let id = world.instance_id();
        self.join_in(&mut world.bind_mut(), id);
    }

    /// Tests whether the world of that instance is the one to join, once it is built.
    pub(crate) fn waits_for(&self, world: InstanceId) -> bool {
        self.world.as_ref().is_none_or(|mine| !mine.is_instance_valid() || mine.instance_id() == world)
    }

    /// Joins the engine that the world has now; `id` is the world's instance.
    pub(crate) fn join_in(&mut self, world: &mut AsperityWorld, id: InstanceId) {
        let name = self.base().get_name().to_string();
        self.surface_id = 0;
        self.body_id = world.join_body(self, &name);
        if self.body_id != 0
            && let Some(surface) = self.surface.clone()
        {
            self.surface_id = world.join_surface(&surface, self.body_id, &name);
        }
        (self.build, self.world) = (world.builds(), Some(Gd::from_instance_id(id)));
    }

    /// The keys of a scene file's `[[body]]`, and where its files lie.
    pub(crate) fn told(&self, name: &str) -> Result<(String, ResFiles, usize, f64), String> {
        let mut table = table_of(&self.table.to_string())?;
        if self.strike_gain >= 0.0 {
            table.insert("strike_gain".into(), Value::Float(self.strike_gain));
        }
        if self.least_time_s > 0.0 {
            table.insert("least_time_s".into(), Value::Float(self.least_time_s));
        }
        let mut say = |key: &str, text: &GString| {
            if !text.is_empty() {
                table.insert(key.into(), Value::String(text.to_string()));
            }
        };
        say("material", &self.material);
        say("modes", &self.modes_file);
        if self.modes_file.is_empty() && !self.stock.is_empty() {
            say("stock", &self.stock);
            table.insert("size_m".into(), Value::Float(self.size_m));
        }
        if !name.is_empty() {
            table.insert("name".into(), Value::String(name.into()));
        }
        let bus = usize::try_from(self.bus)
            .map_err(|_| format!("bus: {} is refused; must be 0 or more", self.bus))?;
        Ok((written(&table)?, ResFiles::default(), bus, self.gain))
    }
}
