//! `asperity study`: pages, the server that saves answers, and the tables of answers.

use crate::support;

use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::io::{BufRead, BufReader, Read, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Command, Stdio};
use support::{Scene, asperity, assert_refused, message};

const HEADER: &str = "participant,trial,protocol,stimulus,shown,answer,correct,response_ms,time";

fn analysed(folder: &Path, arguments: &[&str]) -> Value {
    let mut all = vec!["study", "analyse", "--json"];
    all.extend(arguments);
    let (status, out, err) = message(&asperity(folder, &all));
    assert_eq!((status, err.as_str()), (0, ""));
    serde_json::from_str(&out).unwrap()
}

/// The study that a page carries.
fn carried(page: &Path) -> Value {
    let html = fs::read_to_string(page).unwrap();
    assert!(!html.contains("http://") && !html.contains("https://"), "the page asks somebody");
    let text = html.split_once("id=\"study\">").unwrap().1.split_once("</script>").unwrap().0;
    serde_json::from_str(text).unwrap()
}

#[test]
fn a_stranger_s_scenes_and_wavs_become_one_page_with_numbered_stimuli() {
    let scene = Scene::new();
    let study = "title = \"A & <b>\"\nprotocol = \"rating\"\ntrials = 1\nseed = 3\nscales = [\"quality\"]\nsenses = \"both\"\n\
                 [[stimulus]]\nname = \"full\"\nscene = \"scene.toml\"\nrole = \"reference\"\n\
                 [[stimulus]]\nname = \"other\"\nscene = \"scene.toml\"\n";
    scene.write("study.toml", study);
    let (status, out, err) = message(&asperity(scene.folder.path(), &["study", "study.toml", "-o", "page"]));
    assert_eq!((status, err.as_str()), (0, ""));
    assert!(out.contains("page/index.html"), "{out}");
    let carried = carried(&scene.path("page/index.html"));
    let stimuli = carried["stimuli"].as_array().unwrap();
    // The anchor is made of the reference (ITU-R BS.1534).
    let names: Vec<&str> = stimuli.iter().map(|one| one["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["full", "other", "anchor"]);
    for (number, one) in stimuli.iter().enumerate() {
        for sense in ["sound", "touch"] {
            assert_eq!(one[sense], format!("stimuli/{number:03}.{sense}.wav"));
            let path = scene.path("page").join(one[sense].as_str().unwrap());
            let samples: Vec<i16> =
                hound::WavReader::open(path).unwrap().samples().map(Result::unwrap).collect();
            assert!(samples.iter().any(|x| x.unsigned_abs() > 3000), "{one}");
        }
    }
    assert_eq!(carried["title"], "A & <b>");
}

#[test]
fn every_example_is_a_study_that_becomes_a_page() {
    let folder = tempfile::tempdir().unwrap();
    for (name, stimuli) in
        [("six-plates", 18), ("seven-materials", 21), ("metamers", 10), ("heights", 6), ("dimension", 5)]
    {
        let (status, out, err) = message(&asperity(folder.path(), &["study", "--example", name, "-o", name]));
        assert_eq!((status, err.as_str()), (0, ""));
        assert!(out.contains("next: asperity study"), "{out}");
        let study = format!("{name}/study.toml");
        let (status, out, err) =
            message(&asperity(folder.path(), &["study", &study, "-o", &format!("{name}/page")]));
        assert_eq!((status, err.as_str()), (0, ""), "{name}: {err}");
        assert!(!out.contains("is silent"), "{name}: {out}");
        let page = carried(&folder.path().join(name).join("page/index.html"));
        assert_eq!(page["stimuli"].as_array().unwrap().len(), stimuli, "{name}");
    }
}

#[test]
fn a_study_that_cannot_be_asked_is_refused_in_one_line() {
    let scene = Scene::new();
    let head = "title = \"x\"\nprotocol = \"identification\"\ntrials = 1\nseed = 1\n";
    let two = "[[stimulus]]\nname = \"a\"\nscene = \"scene.toml\"\n[[stimulus]]\nname = \"b\"\nscene = \"scene.toml\"\n";
    for (text, parts) in [
        (head.to_owned(), &["study.toml", "stimulus", "is missing"][..]),
        (format!("{head}colour = 1\n{two}"), &["line 5", "colour", "unknown key"]),
        (format!("{head}{two}").replace("trials = 1", "trials = 0"), &["trials", "1 to 1000"]),
        (format!("{head}{two}").replace("identification", "guessing"), &["protocol", "identification"]),
        (format!("{head}{two}").replace("identification", "rating"), &["scales"]),
        (format!("{head}{two}").replace("identification", "staircase"), &["ladder of levels"]),
        (format!("{head}labels = [\"a\"]\n{two}"), &["stimulus \"b\"", "none of the labels"]),
        (format!("{head}{two}wav = \"x.wav\"\n"), &["stimulus \"b\"", "a scene or a wav"]),
        (format!("{head}{two}").replace("scene.toml", "none.toml"), &["none.toml"]),
        (
            format!("{head}{two}").replacen("scene = \"scene.toml\"", "wav = \"stroke.jsonl\"", 1),
            &["stroke.jsonl", "WAV"],
        ),
    ] {
        scene.write("study.toml", &text);
        assert_refused(&asperity(scene.folder.path(), &["study", "study.toml", "-o", "page"]), parts);
        assert!(!scene.path("page/index.html").exists());
    }
    for arguments in [
        &["study"][..],
        &["study", "study.toml"],
        &["study", "--example", "seven", "-o", "x"],
        &["study", "analyse"],
    ] {
        let (status, out, err) = message(&asperity(scene.folder.path(), arguments));
        assert_eq!((status, out.as_str(), err.lines().count()), (2, "", 1), "{arguments:?}: {err}");
    }
}

#[test]
fn a_confusion_matrix_and_its_intervals_come_from_answer_files() {
    let folder = tempfile::tempdir().unwrap();
    let plates = ["matte-shiny", "shiny-matte", "ridge", "bumps", "sine", "sawtooth"];
    for person in 0..8 {
        let mut text = format!("{HEADER}\n");
        for (index, plate) in plates.iter().enumerate() {
            for trial in 0..3 {
                // Everybody takes sine for bumps once.
                let answer = if *plate == "sine" && trial == 0 { "bumps" } else { plate };
                let right = u8::from(answer == *plate);
                let _ = writeln!(
                    text,
                    "p{person},{},identification,{plate},{plate},{answer},{right},900,2026-01-01T00:00:00Z",
                    3 * index + trial + 1
                );
            }
        }
        text += &format!(
            "p{person},19,attention,attention,ridge,{},{},1,t\n",
            if person == 0 { "sine" } else { "ridge" },
            u8::from(person > 0)
        );
        fs::write(folder.path().join(format!("p{person}.csv")), text).unwrap();
    }
    let files: Vec<String> = (0..8).map(|person| format!("p{person}.csv")).collect();
    let files: Vec<&str> = files.iter().map(String::as_str).collect();
    let report = analysed(folder.path(), &files);
    assert_eq!(
        (&report["protocol"], &report["n"], &report["participants"]),
        (&"identification".into(), &144.into(), &8.into())
    );
    assert_eq!(report["confusion"]["labels"], serde_json::json!(plates));
    assert_eq!(report["confusion"]["counts"][4], serde_json::json!([0, 0, 0, 8, 16, 0]));
    let share = &report["share_correct"];
    assert!((share["value"].as_f64().unwrap() - 136.0 / 144.0).abs() < 1e-12);
    // Wilson 1927 for 136 of 144.
    assert!((share["ci95"][0].as_f64().unwrap() - 0.8941).abs() < 1e-3, "{share}");
    assert!((share["ci95"][1].as_f64().unwrap() - 0.9716).abs() < 1e-3, "{share}");
    assert_eq!(report["attention"]["failed"], serde_json::json!({ "p0": 1 }));
    assert_eq!(report["paper"]["n"], 8);
    let (status, out, _) = message(&asperity(folder.path(), &["study", "analyse", "p0.csv", "p1.csv"]));
    assert!(status == 0 && out.contains("right 0.944 (") && out.contains("Fig. 10"), "{out}");
}

#[test]
fn thresholds_ratings_and_abx_are_reported_with_intervals() {
    let folder = tempfile::tempdir().unwrap();
    let write =
        |name: &str, rows: &str| fs::write(folder.path().join(name), format!("{HEADER}\n{rows}")).unwrap();
    let mut rows = String::new();
    for trial in 0..90 {
        // 1 of 2 right at 1, 3 of 4 at 2, all at 4: the threshold is 2.
        let (level, right) = [(1, trial % 2 == 0), (2, trial / 3 % 4 != 0), (4, true)][trial % 3];
        let _ = writeln!(rows, "p1,{trial},staircase,level,{level},first,{},1,t", u8::from(right));
    }
    write("stairs.csv", &rows);
    let report = analysed(folder.path(), &["stairs.csv"]);
    let threshold = &report["threshold"];
    let ends = [0, 1].map(|end| threshold["ci95"][end].as_f64().unwrap());
    assert!((threshold["value"].as_f64().unwrap() - 2.0).abs() < 0.3, "{threshold}");
    assert!(ends[0] < 2.0 && 2.0 < ends[1] && ends[0] > 1.0 && ends[1] < 4.0, "{threshold}");
    let rated: String = (0..8)
        .flat_map(|p| {
            [1, 2, 4].map(|x| format!("p{p},{x},rating,\"dots, × {x}\",roughness,{},,1,t\n", 10 * x + p))
        })
        .collect();
    write("ratings.csv", &rated);
    let report = analysed(folder.path(), &["ratings.csv"]);
    assert_eq!(report["ratings"][0]["stimulus"], "dots, × 1");
    assert!((report["ratings"][0]["value"].as_f64().unwrap() - 13.5).abs() < 1e-9);
    assert!((report["trend"]["value"].as_f64().unwrap() - 1.0).abs() < 1e-9);
    let abx: String = (0..100)
        .map(|t| {
            format!("p,{t},abx,O1 | O2,O1,{},{},1,t\n", if t < 75 { "O1" } else { "O2" }, u8::from(t < 75))
        })
        .collect();
    write("abx.csv", &abx);
    // Φ(1.266) Φ(0.895) + Φ(−1.266) Φ(−0.895) = 0.8972 · 0.8146 + 0.1028 · 0.1854 = 0.750.
    let d_prime = analysed(folder.path(), &["abx.csv"])["d_prime"].as_f64().unwrap();
    assert!((d_prime - 1.79).abs() < 0.01, "{d_prime}");
    for (name, text, parts) in [
        ("none.csv", "a,b\n".to_owned(), &["none.csv", "is no file of answers"][..]),
        ("short.csv", format!("{HEADER}\np,1,abx\n"), &["short.csv: line 2", "3 fields"]),
        ("right.csv", format!("{HEADER}\np,1,abx,s,s,a,maybe,1,t\n"), &["right.csv: line 2", "maybe"]),
        ("level.csv", format!("{HEADER}\np,1,staircase,s,loud,a,1,1,t\n"), &["shown", "loud"]),
        ("empty.csv", format!("{HEADER}\n"), &["answers: hold none", "one protocol"]),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
        assert_refused(&asperity(folder.path(), &["study", "analyse", name]), parts);
    }
    assert_refused(
        &asperity(folder.path(), &["study", "analyse", "abx.csv", "stairs.csv"]),
        &["one protocol"],
    );
}

#[test]
fn the_server_saves_every_answer_as_it_comes_and_answers_nobody_else() {
    let scene = Scene::new();
    let stimulus = |name: &str| format!("[[stimulus]]\nname = \"{name}\"\nscene = \"scene.toml\"\n");
    let head = "title = \"x\"\nprotocol = \"identification\"\ntrials = 1\nseed = 1\n";
    scene.write("study.toml", format!("{head}{}{}", stimulus("a"), stimulus("b")));
    let mut program = Command::new(env!("CARGO_BIN_EXE_asperity"))
        .args(["study", "study.toml", "--serve", "-o", "page"])
        .current_dir(scene.folder.path())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let lines = BufReader::new(program.stdout.take().unwrap()).lines().map(Result::unwrap);
    let address = lines
        .into_iter()
        .find_map(|line| Some(line.strip_prefix("serving http://")?.split('/').next()?.to_owned()))
        .unwrap();
    let ask = |request: &str, host: &str, body: &str| {
        let mut stream = TcpStream::connect(&address).unwrap();
        write!(
            stream,
            "{request} HTTP/1.1\r\nHost: {host}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{body}",
            body.len()
        )
        .unwrap();
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        String::from_utf8_lossy(&answer).into_owned()
    };
    assert!(ask("GET /", &address, "").contains("<title>x</title>"));
    assert!(ask("GET /answers", &address, "").ends_with("asperity study"));
    let one = format!("{HEADER}\np1,1,identification,a,a,b,0,1,t\n");
    assert!(ask("POST /answers/p1", &address, &one).ends_with("saved"));
    assert!(ask("POST /answers/p1", "elsewhere.example", &one).contains("403"));
    assert!(ask("POST /answers/..%2Fp1", &address, &one).contains("409"));
    assert!(ask("GET /../study.toml", &address, "").contains("404"));
    assert_eq!(fs::read_to_string(scene.path("page/answers/p1.csv")).unwrap(), one);
    assert!(ask("GET /answers/p1.csv", &address, "").contains("405"));
    program.kill().unwrap();
    program.wait().unwrap();
}
