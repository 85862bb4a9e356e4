//! Arrays of a simulator's step, checked whole before anything is taken from them.

use asperity_pairs::{Contact, Mat3, Motion, Placed, Vec3};
use numpy::ndarray::{ArrayView1, ArrayView2, ArrayView3};

/// Thing as Python has it: its body, its surface, material, mobility in 1/kg, form, radius in m,
/// the rows of its velocity and of the place that this belongs to.
pub type Told = (Option<String>, Option<String>, String, f32, String, f64, usize, usize);

/// Arrays of a step of some worlds.
pub struct Step<'a> {
    pub time_s: ArrayView1<'a, f64>,
    pub place: ArrayView3<'a, f64>,
    pub turn: ArrayView3<'a, f64>,
    pub velocity: ArrayView3<'a, f64>,
    pub about: ArrayView3<'a, f64>,
}

/// Points of contact of a step.
pub struct Points<'a> {
    pub world: Option<ArrayView1<'a, i64>>,
    pub pairs: ArrayView2<'a, i32>,
    pub point: ArrayView2<'a, f64>,
    pub normal: ArrayView2<'a, f64>,
    pub force: ArrayView1<'a, f64>,
    /// First rows in `force`; true where a normal force is the sum of all.
    pub efc: Option<(ArrayView1<'a, i32>, bool)>,
    pub restitution: f32,
}

impl Points<'_> {
    pub fn check(&self, worlds: usize, things: usize) -> Result<(), String> {
        let rows = self.pairs.nrows();
        let shape = |name: &str, shape: &[usize], right: &[usize]| match shape == right {
            true => Ok(()),
            false => Err(format!("{name}: has the shape {shape:?}; must be {right:?}")),
        };
        shape("pairs", self.pairs.shape(), &[rows, 2])?;
        shape("point", self.point.shape(), &[rows, 3])?;
        shape("normal", self.normal.shape(), &[rows, 3])?;
        shape("force", &[self.efc.map_or(self.force.len(), |(address, _)| address.len())], &[rows])?;
        if let Some(world) = self.world {
            shape("world", world.shape(), &[rows])?;
            let known = |world: &i64| usize::try_from(*world).is_ok_and(|world| world < worlds);
            if let Some(row) = world.iter().position(|world| !known(world)) {
                return Err(format!("world: row {row} is {}; must be 0 to {}", world[row], worlds - 1));
            }
        }
        let known = |thing: &i32| usize::try_from(*thing).is_ok_and(|thing| thing < things);
        if let Some(row) = self.pairs.rows().into_iter().position(|pair| !pair.iter().all(known)) {
            return Err(format!("pairs: row {row} is {}; must be 0 to {}", self.pairs.row(row), things - 1));
        }
        finite("point", self.point.iter())?;
        finite("normal", self.normal.iter())?;
        finite("force", self.force.iter())
    }

    /// World and contact of each row.
    pub fn contacts(&self) -> impl Iterator<Item = (usize, Contact)> + '_ {
        let space = |row: ArrayView1<'_, f64>| Vec3::new(row[0] as f32, row[1] as f32, row[2] as f32);
        (0..self.pairs.nrows()).map(move |row| {
            let contact = Contact {
                colliders: [0, 1].map(|k| self.pairs[[row, k]] as u32),
                point_m: space(self.point.row(row)),
                normal: space(self.normal.row(row)),
                force_n: self.force_n(row) as f32,
                restitution: self.restitution,
            };
            (self.world.map_or(0, |world| world[row] as usize), contact)
        })
    }

    fn force_n(&self, row: usize) -> f64 {
        let Some((address, sums)) = self.efc else { return self.force[row] };
        // What MuJoCo leaves out of its solver has no row.
        let begins = |row: &i32| usize::try_from(*row).ok();
        let Some(from) = begins(&address[row]) else { return 0.0 };
        // Contacts come last among the rows, one behind the other.
        let next = address.iter().skip(row + 1).find_map(begins).filter(|_| sums);
        let until = next.unwrap_or(if sums { self.force.len() } else { from + 1 });
        self.force.iter().take(until).skip(from).sum()
    }
}

fn finite<'a>(name: &str, mut values: impl Iterator<Item = &'a f64>) -> Result<(), String> {
    match values.position(|value| !value.is_finite()) {
        Some(index) => Err(format!("{name}: number {index} is not finite; must be a number")),
        None => Ok(()),
    }
}

impl Step<'_> {
    pub fn check(&self, last_s: &[Option<f64>], things: &[Option<Told>]) -> Result<(), String> {
        let count = last_s.len();
        let rows = |row: fn(&Told) -> usize| things.iter().flatten().map(row).max().map_or(0, |row| row + 1);
        for (name, array, least, columns) in [
            ("place", &self.place, things.len(), 3),
            ("rotation", &self.turn, things.len(), 9),
            ("velocity", &self.velocity, rows(|told| told.6), 6),
            ("about", &self.about, rows(|told| told.7), 3),
        ] {
            let shape = array.shape();
            if shape[0] != count || shape[1] < least || shape[2] != columns {
                return Err(format!(
                    "{name}: has the shape {shape:?}; must be [{count}, {least}, {columns}]"
                ));
            }
            finite(name, array.iter())?;
        }
        finite("t", self.time_s.iter())?;
        for (index, (last_s, t)) in last_s.iter().zip(self.time_s).enumerate() {
            if let Some(last) = last_s.filter(|last| t <= last) {
                return Err(format!("t: world {index} is at {t} s after {last} s; must grow, or be reset"));
            }
        }
        Ok(())
    }

    /// Place and motion of a thing in a world.
    pub fn placed(&self, world: usize, thing: usize, (row, about): (usize, usize)) -> Placed {
        let space = |array: &ArrayView3<'_, f64>, row: usize, from: usize| {
            Vec3::from_array([0, 1, 2].map(|k| array[[world, row, from + k]] as f32))
        };
        let place_m = space(&self.place, thing, 0);
        let turn = Mat3::from_cols_array(&std::array::from_fn(|k| self.turn[[world, thing, k]] as f32));
        let about = Motion {
            angular_rad_s: space(&self.velocity, row, 0),
            linear_m_s: space(&self.velocity, row, 3),
            centre_m: space(&self.about, about, 0),
        };
        let motion = Motion { linear_m_s: about.at(place_m), centre_m: place_m, ..about };
        // Rows of numpy are columns of the matrix.
        Placed { place_m, turn: turn.transpose(), motion }
    }
}
