//! Gmsh `.msh`, versions 2.2 and 4.1, ASCII and binary (Gmsh reference manual, "MSH file format").
//!
//! Tetrahedra make a volume; the nodes between corners of those of higher order say how their faces
//! curve (`curved`). A file with triangles only is a surface. Node tags may have gaps and any
//! order.

use crate::curved::{self, Between, between};
use crate::error::ShapeError;
use crate::mesh::Mesh;
use crate::surface_mesh::SurfaceMesh;
use crate::vector::Vec3;
use crate::volume_mesh::VolumeMesh;
use std::collections::HashMap;

/// Most nodes or elements that are read.
const MOST: usize = 8_000_000;

/// Words of an ASCII file or numbers of a binary one, in order.
struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    binary: bool,
    swapped: bool,
    /// Name of the section that is read.
    section: &'a str,
}

fn wrong(at: &str, what: impl Into<String>) -> ShapeError {
    ShapeError::new(at, what, "must be a whole Gmsh file of version 2.2 or 4.1")
}

impl<'a> Reader<'a> {
    fn wrong(&self, what: impl Into<String>) -> ShapeError {
        wrong(self.section, what)
    }

    fn line(&mut self) -> Option<&'a str> {
        let rest = self.bytes.get(self.at..).filter(|rest| !rest.is_empty())?;
        let end = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
        self.at += (end + 1).min(rest.len());
        std::str::from_utf8(&rest[..end]).ok().map(str::trim).or(Some(""))
    }

    fn word(&mut self) -> Result<&'a str, ShapeError> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let skip = rest.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(rest.len());
        let rest = &rest[skip..];
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at += skip + end;
        match std::str::from_utf8(&rest[..end]) {
            Ok(word) if !word.is_empty() => Ok(word),
            _ => Err(self.wrong("is cut short")),
        }
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], ShapeError> {
        let part = self.bytes.get(self.at..).and_then(|rest| rest.first_chunk());
        let mut bytes: [u8; N] = *part.ok_or_else(|| self.wrong("is cut short"))?;
        self.at += N;
        if self.swapped {
            bytes.reverse();
        }
        Ok(bytes)
    }

    fn float(&mut self) -> Result<f64, ShapeError> {
        if self.binary {
            return Ok(f64::from_ne_bytes(self.take()?));
        }
        let word = self.word()?;
        word.parse().map_err(|_| self.wrong(format!("`{word}` is no number")))
    }

    /// A number that binary files keep in four bytes.
    fn int(&mut self) -> Result<i64, ShapeError> {
        if self.binary {
            return Ok(i64::from(i32::from_ne_bytes(self.take()?)));
        }
        let word = self.word()?;
        word.parse().map_err(|_| self.wrong(format!("`{word}` is no whole number")))
    }

    /// A number that binary files keep in eight bytes.
    fn size(&mut self) -> Result<i64, ShapeError> {
        if self.binary { Ok(i64::from_ne_bytes(self.take()?)) } else { self.int() }
    }

    fn count(&self, n: i64) -> Result<usize, ShapeError> {
        let count = usize::try_from(n).ok().filter(|&n| n <= MOST);
        count.ok_or_else(|| self.wrong(format!("announces {n} entries, of which at most {MOST} are read")))
    }

    /// The count of version 2: a line of text even in binary files.
    fn counted_line(&mut self) -> Result<usize, ShapeError> {
        let line = self.line().unwrap_or_default();
        let count = line.parse().ok().filter(|&n| n <= MOST);
        count.ok_or_else(|| self.wrong(format!("`{line}` is no count")))
    }

    /// The head of a section of version 4: how many blocks it has.
    fn blocks(&mut self) -> Result<usize, ShapeError> {
        let blocks = self.size()?;
        for _ in 0..3 {
            self.size()?;
        }
        self.count(blocks)
    }

    /// The nodes of an element of a type of Gmsh.
    fn nodes_of(&self, kind: i64) -> Result<usize, ShapeError> {
        const NODES: [usize; 31] = [
            2, 3, 4, 4, 8, 6, 5, 3, 6, 9, 10, 27, 18, 14, 1, 8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5, 6,
            20, 35, 56,
        ];
        let nodes = usize::try_from(kind - 1).ok().and_then(|i| NODES.get(i)).copied();
        nodes.ok_or_else(|| self.wrong(format!("element type {kind} is unknown")))
    }
}

/// Contents of the sections.
#[derive(Default)]
struct Found {
    points: Vec<Vec3>,
    numbers: HashMap<i64, u32>,
    tets: Vec<[i64; 4]>,
    triangles: Vec<[i64; 3]>,
    others: Option<i64>,
    /// Nodes between two corners.
    between: Between,
}

/// Reads a `.msh` file.
///
/// # Errors
/// When it is cut short, of another version, holds solids other than tetrahedra, or names nodes
/// that are not there.
pub fn parse(bytes: &[u8]) -> Result<Mesh, ShapeError> {
    let mut reader = Reader { bytes, at: 0, binary: false, swapped: false, section: "" };
    let mut version = None;
    let mut found = Found::default();
    while let Some(line) = reader.line() {
        reader.section = line;
        match line {
            "$MeshFormat" => version = Some(format(&mut reader)?),
            "$Nodes" => match version {
                Some(4) => nodes_4(&mut reader, &mut found)?,
                Some(_) => nodes_2(&mut reader, &mut found)?,
                None => return Err(reader.wrong("comes before $MeshFormat")),
            },
            "$ParametricNodes" => {
                let right = "save it without them (Gmsh: Mesh.SaveParametric = 0)";
                return Err(ShapeError::new(line, "are nodes with places on their surfaces", right));
            }
            "$Elements" if version == Some(4) => elements_4(&mut reader, &mut found)?,
            "$Elements" => elements_2(&mut reader, &mut found)?,
            _ => continue,
        }
        let end = format!("$End{}", &line[1..]);
        while let Some(next) = reader.line() {
            if next == end {
                break;
            }
            if !next.is_empty() {
                return Err(reader.wrong(format!("does not end with {end}")));
            }
        }
    }
    if version.is_none() {
        return Err(wrong("", "has no $MeshFormat"));
    }
    assemble(found)
}

fn format(reader: &mut Reader<'_>) -> Result<u32, ShapeError> {
    let line = reader.line().unwrap_or_default();
    let words: Vec<&str> = line.split_whitespace().collect();
    let [version, kind, size] = words[..] else { return Err(reader.wrong("is cut short")) };
    if size != "8" {
        return Err(reader.wrong(format!("has numbers of {size} bytes")));
    }
    reader.binary = kind == "1";
    if reader.binary {
        let one: [u8; 4] = reader.take()?;
        reader.swapped = match i32::from_ne_bytes(one) {
            1 => false,
            _ if i32::from_ne_bytes(one).swap_bytes() == 1 => true,
            _ => return Err(reader.wrong("has no byte order")),
        };
    }
    match version {
        "2.2" | "2.1" | "2" | "2.0" => Ok(2),
        "4.1" => Ok(4),
        _ => Err(reader.wrong(format!("is of version {version}"))),
    }
}

fn point(reader: &mut Reader<'_>, found: &mut Found, tag: i64) -> Result<(), ShapeError> {
    let point = [reader.float()?, reader.float()?, reader.float()?];
    if point.iter().any(|x| !x.is_finite()) {
        let what = format!("node {tag} has a coordinate that is not a number");
        return Err(ShapeError::new("$Nodes", what, "must be finite metres"));
    }
    if found.numbers.insert(tag, found.points.len() as u32).is_some() {
        return Err(reader.wrong(format!("node {tag} is there twice")));
    }
    found.points.push(point);
    Ok(())
}

fn nodes_2(reader: &mut Reader<'_>, found: &mut Found) -> Result<(), ShapeError> {
    for _ in 0..reader.counted_line()? {
        let tag = reader.int()?;
        point(reader, found, tag)?;
    }
    Ok(())
}

fn nodes_4(reader: &mut Reader<'_>, found: &mut Found) -> Result<(), ShapeError> {
    for _ in 0..reader.blocks()? {
        let dimension = reader.int()?;
        reader.int()?;
        let parametric = reader.int()? != 0;
        let count = reader.size()?;
        let tags = (0..reader.count(count)?).map(|_| reader.size()).collect::<Result<Vec<i64>, _>>()?;
        for tag in tags {
            point(reader, found, tag)?;
            for _ in 0..if parametric { dimension } else { 0 } {
                reader.float()?;
            }
        }
    }
    Ok(())
}

fn element(found: &mut Found, kind: i64, nodes: &[i64]) {
    match (kind, nodes) {
        (4 | 11 | 29, &[a, b, c, d, ..]) => {
            found.tets.push([a, b, c, d]);
            between(&mut found.between, [[a, b], [b, c], [c, a], [d, a], [d, c], [d, b]], &nodes[4..]);
        }
        (9, &[a, b, c, ab, bc, ca]) => {
            found.triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        (2, &[a, b, c]) => found.triangles.push([a, b, c]),
        (3 | 10 | 16, &[a, b, c, d, ..]) => found.triangles.extend([[a, b, c], [a, c, d]]),
        // Points and lines carry no volume.
        (1 | 8 | 15, _) => {}
        _ => found.others = Some(kind),
    }
}

fn elements_2(reader: &mut Reader<'_>, found: &mut Found) -> Result<(), ShapeError> {
    let mut left = reader.counted_line()?;
    while left > 0 {
        // A text has a number before each element, a binary file a head before groups of them.
        let (kind, group, tags) = if reader.binary {
            (reader.int()?, reader.int()?, reader.int()?)
        } else {
            reader.int()?;
            (reader.int()?, 1, reader.int()?)
        };
        let (group, tags) = (reader.count(group)?.min(left), reader.count(tags)?);
        let nodes = reader.nodes_of(kind)?;
        if group == 0 {
            return Err(reader.wrong("has an empty group"));
        }
        for _ in 0..group {
            for _ in 0..tags + usize::from(reader.binary) {
                reader.int()?;
            }
            let nodes = (0..nodes).map(|_| reader.int()).collect::<Result<Vec<i64>, _>>()?;
            element(found, kind, &nodes);
        }
        left -= group;
    }
    Ok(())
}

fn elements_4(reader: &mut Reader<'_>, found: &mut Found) -> Result<(), ShapeError> {
    for _ in 0..reader.blocks()? {
        reader.int()?;
        reader.int()?;
        let (kind, count) = (reader.int()?, reader.size()?);
        let nodes = reader.nodes_of(kind)?;
        for _ in 0..reader.count(count)? {
            reader.size()?;
            let nodes = (0..nodes).map(|_| reader.size()).collect::<Result<Vec<i64>, _>>()?;
            element(found, kind, &nodes);
        }
    }
    Ok(())
}

fn assemble(found: Found) -> Result<Mesh, ShapeError> {
    let Found { points, numbers, tets, triangles, others, between } = found;
    if let Some(kind) = others {
        let what = format!("holds solids of element type {kind}");
        return Err(ShapeError::new("$Elements", what, "must be 4-node tetrahedra (type 4)"));
    }
    let number = |tag: i64| {
        let unknown = || wrong("$Elements", format!("names node {tag}, which is not there"));
        numbers.get(&tag).copied().ok_or_else(unknown)
    };
    if tets.is_empty() {
        if triangles.is_empty() {
            return Err(ShapeError::new("", "has no tetrahedron and no triangle", "give a body"));
        }
        let triangles = triangles
            .into_iter()
            .map(|[a, b, c]| Ok([number(a)?, number(b)?, number(c)?]))
            .collect::<Result<_, ShapeError>>()?;
        return Ok(Mesh::Surface(SurfaceMesh { points, triangles }));
    }
    let tets = tets
        .into_iter()
        .map(|[a, b, c, d]| Ok([number(a)?, number(b)?, number(c)?, number(d)?]))
        .collect::<Result<_, ShapeError>>()?;
    let volume = VolumeMesh { points, tets };
    let surface = curved::surface(&volume, &between, &numbers);
    Ok(surface.map_or_else(|| Mesh::Volume(volume.clone()), |surface| Mesh::Curved(volume.clone(), surface)))
}
