//! Gmsh files of both versions, as text and in binary, are one body; what is cut short is refused.

use crate::common;

use asperity_shape::volume_mesh::VolumeMesh;
use asperity_shape::{Mesh, load};
use std::path::PathBuf;

/// Node tags with gaps, not in order.
fn tag(i: usize) -> usize {
    7 * (i + 1) + 100 * (i % 2)
}

fn version_2(mesh: &VolumeMesh, binary: bool) -> Vec<u8> {
    let mut out = format!("$MeshFormat\n2.2 {} 8\n", u8::from(binary)).into_bytes();
    if binary {
        out.extend(1_i32.to_ne_bytes());
        out.push(b'\n');
    }
    out.extend(format!("$EndMeshFormat\n$Nodes\n{}\n", mesh.points.len()).bytes());
    for (i, p) in mesh.points.iter().enumerate() {
        if binary {
            out.extend((tag(i) as i32).to_ne_bytes());
            p.iter().for_each(|x| out.extend(x.to_ne_bytes()));
        } else {
            out.extend(format!("{} {} {} {}\n", tag(i), p[0], p[1], p[2]).bytes());
        }
    }
    out.extend(format!("\n$EndNodes\n$Elements\n{}\n", mesh.tets.len()).bytes());
    if binary {
        for x in [4, mesh.tets.len() as i32, 2] {
            out.extend(x.to_ne_bytes());
        }
    }
    for (e, t) in mesh.tets.iter().enumerate() {
        let nodes = t.map(|i| tag(i as usize));
        if binary {
            for x in [e + 1, 0, 1, nodes[0], nodes[1], nodes[2], nodes[3]] {
                out.extend((x as i32).to_ne_bytes());
            }
        } else {
            out.extend(
                format!("{} 4 2 0 1 {} {} {} {}\n", e + 1, nodes[0], nodes[1], nodes[2], nodes[3]).bytes(),
            );
        }
    }
    out.extend(b"\n$EndElements\n");
    out
}

fn version_4(mesh: &VolumeMesh, binary: bool) -> Vec<u8> {
    let mut out = format!("$MeshFormat\n4.1 {} 8\n", u8::from(binary)).into_bytes();
    let put = |out: &mut Vec<u8>, eight: bool, x: usize| match (binary, eight) {
        (true, true) => out.extend((x as u64).to_ne_bytes()),
        (true, false) => out.extend((x as i32).to_ne_bytes()),
        (false, _) => out.extend(format!("{x} ").bytes()),
    };
    if binary {
        out.extend(1_i32.to_ne_bytes());
        out.push(b'\n');
    }
    out.extend(b"$EndMeshFormat\n$Nodes\n");
    let (n, m) = (mesh.points.len(), mesh.tets.len());
    for x in [1, n, 1, 1000] {
        put(&mut out, true, x);
    }
    for x in [3, 1, 0] {
        put(&mut out, false, x);
    }
    put(&mut out, true, n);
    (0..n).for_each(|i| put(&mut out, true, tag(i)));
    for x in mesh.points.iter().flatten() {
        if binary { out.extend(x.to_ne_bytes()) } else { out.extend(format!("{x} ").bytes()) }
    }
    out.extend(b"\n$EndNodes\n$Elements\n");
    for x in [1, m, 1, m] {
        put(&mut out, true, x);
    }
    for x in [3, 1, 4] {
        put(&mut out, false, x);
    }
    put(&mut out, true, m);
    for (e, t) in mesh.tets.iter().enumerate() {
        put(&mut out, true, e + 1);
        t.iter().for_each(|&i| put(&mut out, true, tag(i as usize)));
    }
    out.extend(b"\n$EndElements\n");
    out
}

fn file(name: &str, bytes: &[u8]) -> PathBuf {
    let path = std::env::temp_dir().join(format!("asperity-{}-{name}.msh", std::process::id()));
    std::fs::write(&path, bytes).unwrap();
    path
}

#[test]
fn every_flavour_is_the_same_body_and_half_a_file_is_none() {
    let mesh = common::block([0.1, 0.07, 0.04], [3, 2, 2]);
    for (name, bytes) in [
        ("2a", version_2(&mesh, false)),
        ("2b", version_2(&mesh, true)),
        ("4a", version_4(&mesh, false)),
        ("4b", version_4(&mesh, true)),
    ] {
        let path = file(name, &bytes);
        assert_eq!(load(&path).unwrap(), Mesh::Volume(mesh.clone()), "{name}");
        for part in [10, 30, 50, 70, 90] {
            std::fs::write(&path, &bytes[..bytes.len() * part / 100]).unwrap();
            let message = load(&path).unwrap_err().to_string();
            assert!(message.contains(&path.display().to_string()) && !message.contains('\n'), "{message}");
        }
        std::fs::remove_file(&path).unwrap();
    }
}
