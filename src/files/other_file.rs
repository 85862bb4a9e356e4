//! Files of another kind, given where a scene belongs: which tool reads them.

/// Kind of a file and the tool that reads it, by its first bytes; `None` where it may be a scene
/// with a slip.
pub(crate) fn other_file(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    const RECORDING: (&str, &str) = (
        "is a recording, not a scene",
        "`asperity fit` makes a body of it, `asperity haptic` a clip for hardware",
    );
    const PICTURE: (&str, &str) = (
        "is a picture, not a scene",
        "`asperity texture from-photo` makes a scene of a photograph; a height map goes under displacement in [[surface]]",
    );
    const MESH: (&str, &str) = (
        "is a glTF document, not a scene",
        "`asperity import` makes a scene of it, `asperity modes` a body of a mesh",
    );
    let starts: [(&[u8], (&str, &str)); 16] = [
        (b"RIFF", RECORDING),
        (b"RF64", RECORDING),
        (b"FORM", RECORDING),
        (b"fLaC", RECORDING),
        (b"OggS", RECORDING),
        (b"ID3", RECORDING),
        (b"\xff\xfb", RECORDING),
        (b"\x89PNG", PICTURE),
        (b"\xff\xd8\xff", PICTURE),
        (b"GIF8", PICTURE),
        (b"BM", PICTURE),
        (b"II*\0", PICTURE),
        (b"MM\0*", PICTURE),
        (b"\x76\x2f\x31\x01", PICTURE),
        (b"#?RADIANCE", PICTURE),
        (b"glTF", MESH),
    ];
    if bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP") {
        return Some(PICTURE);
    }
    let known = starts.iter().find(|(start, _)| bytes.starts_with(start)).map(|(_, kind)| *kind);
    known.or_else(|| of_text(std::str::from_utf8(bytes).ok()?.trim_start_matches('\u{feff}').trim_start()))
}

fn of_text(text: &str) -> Option<(&'static str, &'static str)> {
    let head: String = text.chars().take(4096).collect();
    let holds = |word: &str| head.contains(word);
    if head.starts_with('{') && holds("\"event\"") {
        let right = "name it in a scene: contacts = \"NAME.jsonl\"";
        return Some(("is a contact log, not a scene", right));
    }
    if head.starts_with('{') && holds("asperity.modes") {
        let right = "name it in a scene: modes = \"NAME.modes.json\" under [[body]]";
        return Some(("is a modes file, not a scene", right));
    }
    if head.starts_with('{') && holds("\"asset\"") {
        return Some(("is a glTF document, not a scene", "`asperity import` makes a scene of it"));
    }
    let first = head.lines().next().unwrap_or_default();
    if first.matches([',', ';', '\t']).count() > 1 && !first.contains(['=', '[', '{', '#']) {
        let right =
            "a scene is TOML, a contact log one JSON object a line; docs/formats has the keys of both";
        return Some(("is a table (CSV), not a scene", right));
    }
    let is_mesh = head.lines().any(|line| line.starts_with("v "))
        || head.starts_with("solid ")
        || head.starts_with("$MeshFormat");
    is_mesh.then_some(("is a mesh, not a scene", "`asperity modes` makes a body of it"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_another_kind_is_sent_to_its_tool() {
        for (bytes, word) in [
            (&b"RIFF\0\0\0\0WAVEfmt "[..], "`asperity fit`"),
            (b"RIFF\0\0\0\0WEBPVP8 ", "from-photo"),
            (b"\x89PNG\r\n\x1a\n", "from-photo"),
            (b"\xff\xd8\xff\xe0", "from-photo"),
            (b"glTF\x02\0\0\0", "`asperity import`"),
            (b"{\"t\":0,\"event\":\"end\",\"contact\":1}", "contacts = "),
            (b"{\"format\":\"asperity.modes\"}", "[[body]]"),
            (b"# Blender\nv 0 0 0\n", "`asperity modes`"),
            (b"time,u,v,force\n0,0.1,0.2,0.5\n", "one JSON object a line"),
        ] {
            assert!(other_file(bytes).is_some_and(|(_, right)| right.contains(word)), "{word}");
        }
        for scene in ["sample_rate_hz = 44100\n", "", "[[surface]]\nname = \"x\"", "seed = 1\nBM = 2"] {
            assert_eq!(other_file(scene.as_bytes()), None, "{scene}");
        }
    }
}
