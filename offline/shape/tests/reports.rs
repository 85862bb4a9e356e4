//! Mesh files that readers of other projects were reported to fail at, as their programs write
//! them: each is the same box, or is refused for what it is.

use asperity_shape::eigenmodes::Wanted;
use asperity_shape::surface_mesh::SurfaceMesh;
use asperity_shape::{Elastic, Making, Mesh, ShapeError, make, parse};
use std::fmt::Write;
use std::path::Path;

const POINTS: [[f64; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [0.1, 0.0, 0.0],
    [0.1, 0.06, 0.0],
    [0.0, 0.06, 0.0],
    [0.0, 0.0, 0.02],
    [0.1, 0.0, 0.02],
    [0.1, 0.06, 0.02],
    [0.0, 0.06, 0.02],
];
const FACES: [[u32; 4]; 6] =
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

fn read(name: &str, bytes: &[u8]) -> Result<SurfaceMesh, ShapeError> {
    match parse(Path::new(name), bytes)? {
        Mesh::Surface(surface) => Ok(surface),
        Mesh::Volume(_) | Mesh::Curved(..) => panic!("{name}: a volume"),
    }
}

fn volume_m3(mesh: &SurfaceMesh) -> f64 {
    let six = |&[a, b, c]: &[u32; 3]| {
        let [a, b, c] = [a, b, c].map(|i| mesh.points[i as usize]);
        a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    mesh.triangles.iter().map(six).sum::<f64>() / 6.0
}

#[track_caller]
fn is_the_box(name: &str, bytes: &[u8]) {
    let mesh = read(name, bytes).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(mesh.triangles.len(), 12, "{name}");
    assert!((volume_m3(&mesh) / 1.2e-4 - 1.0).abs() < 1e-6, "{name}: {}", volume_m3(&mesh));
}

fn obj(corner: impl Fn(u32) -> String, end: &str) -> String {
    let mut text = String::from("mtllib a.mtl\no box\n");
    POINTS.iter().for_each(|[x, y, z]| _ = writeln!(text, "v {x} {y} {z}{end}"));
    for face in FACES {
        text.push('f');
        face.iter().for_each(|&i| _ = write!(text, " {}", corner(i)));
        text.push_str(end);
        text.push('\n');
    }
    text
}

#[test]
fn an_obj_counts_from_the_end_and_skips_missing_parts() {
    let of = |corner: &dyn Fn(u32) -> String, end: &str| is_the_box("a.obj", obj(corner, end).as_bytes());
    of(&|i| format!("{}//{}", i as i64 - 8, i as i64 - 8), "");
    of(&|i| format!("{}//", i + 1), "");
    of(&|i| format!("{}/0/0", i + 1), "");
    of(&|i| format!("{}/9999/9999", i + 1), "");
    of(&|i| format!("{}", i + 1), " # made by hand");
    of(&|i| format!("{}", i + 1), "\r");
    let coloured = obj(|i| format!("{}", i + 1), "").replace("0.02\n", "2e-2 0.5 0.5 0.5\n");
    is_the_box("a.obj", coloured.as_bytes());
}

/// A binary PLY whose rows `rest` follow those of vertices and faces.
fn ply(mark: &str, count: &str, more: &str, rest: &[u8]) -> Vec<u8> {
    let head = format!(
        "ply\nformat binary_little_endian 1.0\ncomment made\nelement vertex 8\nproperty double x\n\
         property double y\nproperty double z\nproperty uchar red\nelement face 6\n\
         property list uchar float texcoord\nproperty list {count} int vertex_indices\n{more}end_header\n"
    );
    let mut bytes = head.replace('\n', mark).into_bytes();
    for point in POINTS {
        point.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
        bytes.push(b'\n');
    }
    for face in FACES {
        bytes.push(1);
        bytes.extend(0.5_f32.to_le_bytes());
        let size = if count == "uchar" { 1 } else { 2 };
        bytes.extend(&4_u16.to_le_bytes()[..size]);
        face.iter().for_each(|i| bytes.extend(i.to_le_bytes()));
    }
    bytes.extend(rest);
    bytes
}

#[test]
fn a_ply_is_read_however_its_header_ends_its_lines() {
    for mark in ["\n", "\r\n", "\n\r", "\r"] {
        is_the_box("a.ply", &ply(mark, "uchar", "", &[]));
        let text = "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n\
                    property float z\nelement face 6\nproperty list int int vertex_index\nend_header\n";
        let mut text = text.to_owned();
        POINTS.iter().for_each(|[x, y, z]| _ = writeln!(text, "{x} {y} {z}"));
        FACES.iter().for_each(|[a, b, c, d]| _ = writeln!(text, "4 {a} {b} {c} {d}"));
        is_the_box("a.ply", text.replace('\n', mark).as_bytes());
        is_the_box("a.ply", text.trim_end().replace('\n', mark).as_bytes());
    }
}

#[test]
fn a_ply_with_long_lists_and_elements_of_its_own_is_read() {
    is_the_box("a.ply", &ply("\n", "ushort", "", &[]));
    let own = "element patch 1\nproperty list uchar ushort corners\nproperty double weight\n";
    is_the_box("a.ply", &ply("\n", "uchar", own, &[2, 1, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0]));
}

fn triangles() -> Vec<[[f64; 3]; 3]> {
    let corners = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
    FACES.into_iter().flat_map(corners).map(|t| t.map(|i| POINTS[i as usize])).collect()
}

#[test]
fn an_stl_of_two_solids_or_a_misleading_header_is_read() {
    let mut text = String::new();
    for (number, part) in triangles().chunks(6).enumerate() {
        _ = writeln!(text, "solid part {number}");
        for corners in part {
            text.push_str("  facet normal 0 0 0\n    outer loop\n");
            corners.iter().for_each(|[x, y, z]| _ = writeln!(text, "      vertex {x:E} {y:E} {z:E}"));
            text.push_str("    endloop\n  endfacet\n");
        }
        _ = writeln!(text, "endsolid part {number}");
    }
    is_the_box("a.stl", text.as_bytes());
    let comma = read("a.stl", text.replace("1E-1", "0,1").as_bytes()).unwrap_err().to_string();
    assert!(comma.contains("line") && comma.contains("vertex X Y Z"), "{comma}");
    let mut binary = b"solid base\nfacet".to_vec();
    binary.resize(80, b' ');
    binary.extend(12_u32.to_le_bytes());
    for corners in triangles() {
        binary.extend([0; 12]);
        corners.iter().flatten().for_each(|x| binary.extend((*x as f32).to_le_bytes()));
        binary.extend([0xff, 0x7f]);
    }
    is_the_box("a.stl", &binary);
}

/// A box of triangles as Gmsh 4.1, its nodes in an order of their own.
fn msh() -> String {
    let mut text = String::from("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 8 1 8\n2 1 0 8\n");
    let order = [0, 1, 2, 7, 6, 5, 4, 3];
    order.iter().for_each(|i| _ = writeln!(text, "{}", i + 1));
    order
        .iter()
        .for_each(|&i: &usize| _ = writeln!(text, "{} {} {}", POINTS[i][0], POINTS[i][1], POINTS[i][2]));
    text.push_str("$EndNodes\n$Elements\n1 6 1 6\n2 1 3 6\n");
    for (n, [a, b, c, d]) in FACES.iter().enumerate() {
        _ = writeln!(text, "{} {} {} {} {}", n + 1, a + 1, b + 1, c + 1, d + 1);
    }
    text.push_str("$EndElements\n");
    text
}

#[test]
fn a_msh_without_groups_and_with_unordered_nodes_is_read() {
    is_the_box("a.msh", msh().as_bytes());
    is_the_box("a.msh", msh().replace('\n', "\r\n").as_bytes());
    let error = read("a.msh", b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$ParametricNodes\n1\n1 0 0 0 0 1\n");
    let error = error.unwrap_err().to_string();
    assert!(error.contains("$ParametricNodes") && error.contains("SaveParametric"), "{error}");
}

fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for part in bytes.chunks(3) {
        let number = part.iter().fold(0_u32, |n, b| n << 8 | u32::from(*b)) << (8 * (3 - part.len()));
        for k in 0..4 {
            let letter = LETTERS[(number >> (18 - 6 * k) & 63) as usize] as char;
            text.push(if k <= part.len() { letter } else { '=' });
        }
    }
    text
}

/// A glTF of one primitive with these accessors over one buffer of the views (offset, length).
fn gltf(buffer: &[u8], kind: &str, views: &[[usize; 2]], accessors: &str, primitive: &str) -> String {
    let views: Vec<String> = views
        .iter()
        .map(|[at, length]| format!("{{\"buffer\":0,\"byteOffset\":{at},\"byteLength\":{length}}}"))
        .collect();
    format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"scene\":0,\"scenes\":[{{\"nodes\":[0]}}],\"nodes\":[{{\"mesh\":0}}],\
         \"meshes\":[{{\"primitives\":[{primitive}]}}],\"accessors\":[{accessors}],\"bufferViews\":[{}],\
         \"buffers\":[{{\"byteLength\":{},\"uri\":\"data:application/{kind};base64,{}\"}}]}}",
        views.join(","),
        buffer.len(),
        base64(buffer)
    )
}

fn bytes_of(points: &[[f64; 3]]) -> Vec<u8> {
    points.iter().flatten().flat_map(|x| (*x as f32).to_le_bytes()).collect()
}

#[test]
fn a_gltf_without_indices_in_its_own_buffer_is_read() {
    let corners = triangles().concat();
    let buffer = bytes_of(&corners);
    let positions = "{\"bufferView\":0,\"componentType\":5126,\"count\":36,\"type\":\"VEC3\",\
                     \"min\":[0,0,0],\"max\":[0.1,0.06,0.02]}";
    for kind in ["octet-stream", "gltf-buffer"] {
        let file = gltf(&buffer, kind, &[[0, buffer.len()]], positions, "{\"attributes\":{\"POSITION\":0}}");
        is_the_box("a.gltf", file.as_bytes());
    }
}

#[test]
fn a_gltf_of_strips_is_read() {
    // A strip for each face.
    let mut buffer = bytes_of(&POINTS);
    for [a, b, c, d] in FACES {
        [a, b, d, c].iter().for_each(|i| buffer.extend((*i as u16).to_le_bytes()));
    }
    let mut accessors = String::from(
        "{\"bufferView\":0,\"componentType\":5126,\"count\":8,\"type\":\"VEC3\",\
         \"min\":[0,0,0],\"max\":[0.1,0.06,0.02]}",
    );
    let mut primitives = Vec::new();
    for face in 0..6 {
        let at = 8 * face;
        _ = write!(
            accessors,
            ",{{\"bufferView\":1,\"byteOffset\":{at},\"componentType\":5123,\"count\":4,\"type\":\"SCALAR\"}}"
        );
        let indices = face + 1;
        primitives.push(format!("{{\"attributes\":{{\"POSITION\":0}},\"indices\":{indices},\"mode\":5}}"));
    }
    let file = gltf(&buffer, "octet-stream", &[[0, 96], [96, 48]], &accessors, &primitives.join(","));
    is_the_box("a.gltf", file.as_bytes());
}

/// Refused with "is VEC3; must be plain numbers of type VEC3".
#[test]
fn a_gltf_with_sparse_points_is_read_and_its_faults_are_named() {
    let indices: Vec<u8> = FACES
        .iter()
        .flat_map(|[a, b, c, d]| [*a, *b, *c, *a, *c, *d])
        .flat_map(|i| (i as u16).to_le_bytes())
        .collect();
    let primitive = "{\"attributes\":{\"POSITION\":0},\"indices\":1}";
    let file = |base: &str, written: &[(u8, usize)]| {
        // Rows that are wrong, which rows are written, and with what.
        let mut buffer = bytes_of(&[[9.0; 3]; 8]);
        buffer.extend(&indices);
        let rows_at = buffer.len();
        buffer.extend(written.iter().map(|(row, _)| *row));
        buffer.resize(buffer.len().next_multiple_of(4), 0);
        let values_at = buffer.len();
        buffer.extend(bytes_of(&written.iter().map(|(_, point)| POINTS[*point]).collect::<Vec<_>>()));
        let views =
            [[0, 96], [96, indices.len()], [rows_at, written.len()], [values_at, buffer.len() - values_at]];
        let count = written.len();
        let accessors = format!(
            "{{{base}\"componentType\":5126,\"count\":8,\"type\":\"VEC3\",\"sparse\":{{\"count\":{count},\
             \"indices\":{{\"bufferView\":2,\"componentType\":5121}},\"values\":{{\"bufferView\":3}}}}}},\
             {{\"bufferView\":1,\"componentType\":5123,\"count\":36,\"type\":\"SCALAR\"}}"
        );
        gltf(&buffer, "octet-stream", &views, &accessors, primitive)
    };
    let all: Vec<(u8, usize)> = (0..8).map(|i| (i as u8, i)).collect();
    is_the_box("a.gltf", file("\"bufferView\":0,", &all).as_bytes());
    // Without a buffer every row is zeros, as the box's first corner is.
    let zero = POINTS.iter().position(|p| *p == [0.0; 3]).unwrap();
    let others: Vec<(u8, usize)> = all.iter().copied().filter(|(_, i)| *i != zero).collect();
    is_the_box("a.gltf", file("", &others).as_bytes());
    let astray = [&all[..7], &[(8, 7)]].concat();
    let error = read("a.gltf", file("\"bufferView\":0,", &astray).as_bytes()).unwrap_err().to_string();
    assert!(error.contains("sparse") && error.contains("row 8"), "{error}");
    let vast = file("", &others).replacen("\"count\":8", "\"count\":99999999999", 1);
    assert!(read("a.gltf", vast.as_bytes()).unwrap_err().to_string().contains("99999999999"));
}

#[test]
fn a_gltf_whose_triangles_are_packed_by_an_extension_names_it() {
    let file = gltf(&[0; 12], "octet-stream", &[[0, 12]], "{\"componentType\":5126,\"count\":8,\"type\":\"VEC3\"}",
        "{\"attributes\":{\"POSITION\":0},\"extensions\":{\"KHR_draco_mesh_compression\":{\"bufferView\":0,\"attributes\":{\"POSITION\":0}}}}")
        .replace("\"scene\":0", "\"extensionsUsed\":[\"KHR_draco_mesh_compression\"],\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"scene\":0");
    let error = read("a.gltf", file.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("Draco"), "{error}");
}

/// Refused for "845429046 triangles", "no face", "no whole PLY".
#[test]
fn what_a_download_left_in_place_of_a_mesh_is_named() {
    let pointer =
        format!("version https://git-lfs.github.com/spec/v1\noid sha256:{}\nsize 9\n", "4d".repeat(32));
    let page = format!("\n<!DOCTYPE html>\n<html><body>{}</body></html>", "Not found. ".repeat(9));
    for ending in ["obj", "stl", "ply", "glb", "gltf", "msh"] {
        let error = |text: &str| read(&format!("a.{ending}"), text.as_bytes()).unwrap_err().to_string();
        assert!(error(&pointer).contains("Git LFS"), "{}", error(&pointer));
        assert!(error(&page).contains("web page"), "{}", error(&page));
    }
    let error = read("a.stl", "no triangles here. ".repeat(9).as_bytes()).unwrap_err().to_string();
    assert!(error.contains("a text without `facet`"), "{error}");
}

/// Refused for "walls of 1.4 mm": a cube one corner of which one triangle misses by 4 %.
#[test]
fn a_cube_gaping_at_a_corner_is_refused_with_its_closures() {
    let mut mesh = SurfaceMesh::default();
    for corners in triangles() {
        let first = mesh.points.len() as u32;
        mesh.points.extend(corners.map(|[x, y, z]| [x, y / 0.6, z / 0.2]));
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    let astray = mesh.points.iter_mut().find(|[x, y, z]| *x == 0.0 && y.min(*z) > 0.09).unwrap();
    *astray = [0.0026, 0.0974, 0.0974];
    let material = Elastic { young_pa: 70e9, poisson: 0.24, density_kg_m3: 2400.0 };
    let wanted = Wanted { up_to_hz: None, most: 4 };
    let making = Making { material, size_m: None, unit_m: None, thickness_m: None, wanted };
    let error = make(Mesh::Surface(mesh), &making, &mut |_| ()).unwrap_err().to_string();
    assert!(error.contains("holes were closed") && !error.contains('\n'), "{error}");
}

/// Took half a minute of one processor: each name was looked for among all before it.
#[test]
fn one_group_of_a_scene_of_two_hundred_thousand_is_read() {
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let groups: String = (0..200_000).map(|i| format!("g block{i}\nf 1 2 3\n")).collect();
    let path = std::env::temp_dir().join(format!("asperity-groups-{}.obj", std::process::id()));
    std::fs::write(&path, format!("{corners}{groups}")).unwrap();
    let part = asperity_shape::load_part(&path, Some("block199999"));
    std::fs::remove_file(&path).unwrap();
    let Ok(Mesh::Surface(part)) = part else { panic!("{part:?}") };
    assert_eq!(part.triangles.len(), 1);
}

/// Scans of the nineties come so; they were refused as points without a face.
#[test]
fn a_ply_of_strips_is_the_body() {
    let mut text =
        "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n\
                    element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
            .to_owned();
    POINTS.iter().for_each(|[x, y, z]| writeln!(text, "{x} {y} {z}").unwrap());
    text.push_str("20 0 4 1 5 2 6 3 7 0 4 -1 0 1 3 2 -1 4 7 5 6\n");
    let Mesh::Surface(mesh) = parse(Path::new("box.ply"), text.as_bytes()).unwrap() else {
        panic!("no surface")
    };
    let volume_m3: f64 = mesh
        .triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|i| mesh.points[i as usize]);
            let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
            (a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]) / 6.0
        })
        .sum();
    assert!(mesh.triangles.len() == 12 && (volume_m3.abs() / 1.2e-4 - 1.0).abs() < 1e-6, "{volume_m3}");
}
