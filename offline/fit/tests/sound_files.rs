//! Sound files as recorders, editors and libraries write them, made here byte by byte: the same
//! sound comes out of all, and what cannot be read is named in one line.

use asperity_fit::{ChannelChoice, Recording, RecordingError, load};
use std::path::PathBuf;

const FRAMES: usize = 3000;

/// Integers of 16 bits, two channels, the second one louder.
fn sound() -> Vec<[i16; 2]> {
    let at = |n: usize| {
        let t = n as f64 / 44_100.0;
        let x = (-30.0 * t).exp() * (2.0 * std::f64::consts::PI * 700.0 * t).sin();
        [(9000.0 * x) as i16, (30_000.0 * x) as i16]
    };
    (0..FRAMES).map(at).collect()
}

fn chunk(name: &[u8; 4], bytes: &[u8]) -> Vec<u8> {
    let mut out = name.to_vec();
    out.extend((bytes.len() as u32).to_le_bytes());
    out.extend(bytes);
    out.resize(out.len() + bytes.len() % 2, 0);
    out
}

fn format(tag: u16, bits: u16, frame_bytes: u16) -> Vec<u8> {
    let mut out = tag.to_le_bytes().to_vec();
    out.extend(2_u16.to_le_bytes());
    out.extend(44_100_u32.to_le_bytes());
    out.extend((44_100 * u32::from(frame_bytes)).to_le_bytes());
    out.extend(frame_bytes.to_le_bytes());
    out.extend(bits.to_le_bytes());
    out
}

/// The extensible format of `tag`: so many valid bits in so many.
fn extensible(tag: u16, valid: u16, bits: u16) -> Vec<u8> {
    let mut out = format(0xfffe, bits, bits / 4);
    out.extend(22_u16.to_le_bytes());
    out.extend(valid.to_le_bytes());
    out.extend(3_u32.to_le_bytes());
    out.extend(tag.to_le_bytes());
    out.extend([0, 0, 0, 0, 0x10, 0, 0x80, 0, 0, 0xaa, 0, 0x38, 0x9b, 0x71]);
    out
}

fn riff(name: &[u8; 4], chunks: &[Vec<u8>]) -> Vec<u8> {
    let body = chunks.concat();
    let mut out = name.to_vec();
    out.extend((body.len() as u32 + 4).to_le_bytes());
    out.extend(b"WAVE");
    out.extend(body);
    out
}

/// Every sample by `write`.
fn data(write: impl Fn(i16) -> Vec<u8>) -> Vec<u8> {
    sound().into_iter().flatten().flat_map(write).collect()
}

fn pcm16() -> Vec<u8> {
    data(|x| x.to_le_bytes().to_vec())
}

/// Writes the bytes as a file and reads them again.
fn read(name: &str, bytes: &[u8]) -> Result<Recording, RecordingError> {
    let folder = std::env::temp_dir().join(format!("asperity-sound-files-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path: PathBuf = folder.join(name.replace(' ', "_"));
    std::fs::write(&path, bytes).unwrap();
    let recording = load(&path, ChannelChoice::Loudest);
    std::fs::remove_file(path).unwrap();
    recording
}

fn assert_same(name: &str, bytes: &[u8]) {
    let recording = read(name, bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_eq!((recording.samples.len(), recording.sample_rate_hz), (FRAMES, 44_100.0), "{name}");
    assert!(!recording.truncated, "{name}");
    for (read, [_, x]) in recording.samples.iter().zip(sound()) {
        assert_eq!(*read, f64::from(x) / 32_768.0, "{name}");
    }
}

#[test]
fn wav_of_every_width_is_the_same_sound() {
    let plain = chunk(b"fmt ", &format(1, 16, 4));
    let samples = chunk(b"data", &pcm16());
    let wide = |bytes: usize| data(move |x| [vec![0; bytes - 2], x.to_le_bytes().to_vec()].concat());
    let float32 = data(|x| (f32::from(x) / 32_768.0).to_le_bytes().to_vec());
    let float64 = data(|x| (f64::from(x) / 32_768.0).to_le_bytes().to_vec());
    assert_same("plain", &riff(b"RIFF", &[plain.clone(), samples.clone()]));
    assert_same("24", &riff(b"RIFF", &[chunk(b"fmt ", &format(1, 24, 6)), chunk(b"data", &wide(3))]));
    assert_same("32", &riff(b"RIFF", &[chunk(b"fmt ", &format(1, 32, 8)), chunk(b"data", &wide(4))]));
    let in_32 = chunk(b"fmt ", &extensible(1, 24, 32));
    assert_same("24 in 32", &riff(b"RIFF", &[in_32, chunk(b"data", &wide(4))]));
    assert_same("f32", &riff(b"RIFF", &[chunk(b"fmt ", &format(3, 32, 8)), chunk(b"data", &float32)]));
    assert_same("f64", &riff(b"RIFF", &[chunk(b"fmt ", &format(3, 64, 16)), chunk(b"data", &float64)]));
    let extended = chunk(b"fmt ", &extensible(3, 64, 64));
    assert_same("f64 extensible", &riff(b"RIFF", &[extended, chunk(b"data", &float64)]));
    // What field recorders and editors put before and after the sound.
    let list = chunk(b"LIST", b"abc");
    let bext = chunk(b"bext", &[7; 605]);
    assert_same(
        "odd chunks",
        &riff(b"RIFF", &[list.clone(), plain.clone(), bext, samples.clone(), list.clone()]),
    );
    // Sizes that are said elsewhere or not at all.
    let mut unsaid = chunk(b"data", &pcm16());
    unsaid[4..8].fill(0xff);
    let mut sizes = u64::MAX.to_le_bytes().to_vec();
    sizes.extend((pcm16().len() as u64).to_le_bytes());
    sizes.extend((FRAMES as u64).to_le_bytes());
    sizes.extend(0_u32.to_le_bytes());
    let long = [chunk(b"ds64", &sizes), plain.clone(), unsaid.clone(), list];
    assert_same("RF64", &riff(b"RF64", &long));
    assert_same("BW64", &riff(b"BW64", &long));
    assert_same("streamed", &riff(b"RIFF", &[plain.clone(), unsaid.clone()]));
    unsaid[4..8].fill(0);
    assert_same("no size", &riff(b"RIFF", &[plain, unsaid]));
}

/// One FLAC stream of verbatim blocks.
fn flac() -> Vec<u8> {
    let crc = |bytes: &[u8], width: u32, polynomial: u32| {
        let top = 1_u32 << (width - 1);
        bytes.iter().fold(0_u32, |crc, byte| {
            (0..8).fold(crc ^ u32::from(*byte) << (width - 8), |crc, _| {
                if crc & top != 0 { (crc << 1) ^ polynomial } else { crc << 1 }
            }) & ((top << 1) - 1)
        })
    };
    let block = 1000_u16;
    let mut out = b"fLaC\x80\0\0\x22".to_vec();
    out.extend([block.to_be_bytes(), block.to_be_bytes()].concat());
    out.extend([0; 6]);
    // 20 bits of rate, 3 of channels − 1, 5 of bits − 1, 36 of frames.
    out.extend((44_100_u64 << 44 | 1 << 41 | 15 << 36 | FRAMES as u64).to_be_bytes());
    out.extend([0; 16]);
    for (number, frames) in sound().chunks(usize::from(block)).enumerate() {
        let mut frame = vec![0xff, 0xf8, 0x70, 0x10, number as u8];
        frame.extend((block - 1).to_be_bytes());
        frame.push(crc(&frame, 8, 0x07) as u8);
        for channel in 0..2 {
            frame.push(0x02);
            frame.extend(frames.iter().flat_map(|x| x[channel].to_be_bytes()));
        }
        let check = crc(&frame, 16, 0x8005) as u16;
        frame.extend(check.to_be_bytes());
        out.extend(frame);
    }
    out
}

#[test]
fn flac_is_the_same_sound_to_the_bit() {
    assert_same("flac", &flac());
    let whole = read("flac", &flac()).unwrap();
    assert_eq!(whole.quantum, 0.5_f64.powi(15));
    // It breaks off within the third block.
    let cut = read("cut flac", &flac()[..9000]).unwrap();
    assert!(cut.truncated && cut.samples.len() == 2000, "{} {}", cut.truncated, cut.samples.len());
}

#[test]
fn what_cannot_be_read_is_named_in_one_line() {
    let plain = chunk(b"fmt ", &format(1, 16, 4));
    let of = |format: Vec<u8>| riff(b"RIFF", &[chunk(b"fmt ", &format), chunk(b"data", &pcm16())]);
    let mut own = extensible(1, 16, 16);
    own[30] = 9;
    let cases: [(&str, Vec<u8>, &str); 21] = [
        ("mp3", [b"\xff\xfb\x90".to_vec(), vec![0; 99]].concat(), "MP3"),
        ("tag alone", [b"ID3\x04".to_vec(), vec![0; 99]].concat(), "zeros"),
        ("aiff", b"FORM\0\0\0\x10AIFFCOMM".to_vec(), "AIFF"),
        ("m4a", b"\0\0\0\x20ftypM4A \0\0\0\0".to_vec(), "M4A"),
        ("caf", b"caff\0\x01\0\0desc".to_vec(), "CAF"),
        ("au", b".snd\0\0\0\x18\0\0\0\0".to_vec(), "AU"),
        ("webm", b"\x1a\x45\xdf\xa3\0\0\0\0\0\0\0\0".to_vec(), "WebM"),
        ("8svx", b"FORM\0\0\0\x108SVXVHDR".to_vec(), "no AIFF"),
        ("gsm", aiff_c(b"GSM ", 16, &pcm16()), "AIFF packed in a way that is not read"),
        ("pointer", b"version https://git-lfs.github.com/spec/v1".to_vec(), "Git LFS"),
        ("page", b"<!DOCTYPE html><html>".to_vec(), "web page"),
        ("text", b"this is no sound at all".to_vec(), "no header"),
        ("zeros", vec![0; 400], "zeros"),
        ("avi", b"RIFF\x10\0\0\0AVI LIST".to_vec(), "no WAVE"),
        ("head", riff(b"RIFF", std::slice::from_ref(&plain))[..30].to_vec(), "ends within its header"),
        ("no data", riff(b"RIFF", std::slice::from_ref(&plain)), "without a data chunk"),
        ("no format", riff(b"RIFF", &[chunk(b"data", &pcm16())]), "before its format"),
        ("adpcm", of(format(0x11, 4, 4)), "IMA ADPCM"),
        ("own", of(own), "maker's own"),
        ("frames", of(format(1, 16, 3)), "frames of 3 bytes"),
        ("opus", b"OggS\0\x02\0\0\0\0\0\0\0\0\x01\0\0\0\0\0\0\0\0\0\0\0\x01\x13OpusHead\x01\x02\0\0\x80\xbb\0\0\0\0\0".to_vec(), "Ogg"),
    ];
    for (name, bytes, what) in cases {
        let error = read(name, &bytes).unwrap_err().to_string();
        assert!(
            error.contains(what) && error.contains(&name.replace(' ', "_")) && !error.contains('\n'),
            "{name}: {error}"
        );
    }
}

#[test]
fn a_wav_file_that_breaks_off_is_a_recording_that_says_so() {
    let file = riff(b"RIFF", &[chunk(b"fmt ", &format(1, 16, 4)), chunk(b"data", &pcm16())]);
    let cut = read("cut", &file[..44 + 4 * 2000 + 1]).unwrap();
    assert!(cut.truncated && cut.samples.len() == 2000, "{} {}", cut.truncated, cut.samples.len());
}

/// Refused as "without a data chunk" before; other readers skip what is no pad byte.
#[test]
fn a_wav_file_whose_odd_chunk_has_no_pad_byte_is_read() {
    for odd in [chunk(b"LIST", b"INFOx"), chunk(b"LIST", b"INFOx")[..13].to_vec()] {
        let chunks = [chunk(b"fmt ", &format(1, 16, 4)), odd, chunk(b"data", &pcm16())];
        let sound = read("odd", &riff(b"RIFF", &chunks)).unwrap();
        let plain = read("plain", &riff(b"RIFF", &[chunks[0].clone(), chunks[2].clone()])).unwrap();
        assert_eq!((sound.samples, sound.truncated), (plain.samples, false));
    }
}

/// Reported as "truncated" and copied again in vain: a file that was written into a pipe.
#[test]
fn a_wav_of_unknown_length_is_not_called_truncated() {
    for said in [0, 0x7fff_0000, 0x7fff_ffff, 0x8000_0000, u32::MAX] {
        let mut file = riff(b"RIFF", &[chunk(b"fmt ", &format(1, 16, 4)), chunk(b"data", &pcm16())]);
        file[40..44].copy_from_slice(&said.to_le_bytes());
        let whole = read("pipe", &file).unwrap();
        assert!(!whole.truncated && whole.samples.len() == FRAMES, "{said:x}");
    }
}

/// An ID3v2 tag of so many bytes in all.
fn tag(version: u8, bytes: usize) -> Vec<u8> {
    let size = bytes - 10;
    let sizes = [21, 14, 7, 0].map(|shift| (size >> shift & 0x7f) as u8);
    let mut tag = [b"ID3".to_vec(), vec![version, 0, 0], sizes.to_vec()].concat();
    tag.resize(bytes, 0);
    tag
}

/// 16-bit AIFF of the same two channels.
fn aiff() -> Vec<u8> {
    let little = pcm16();
    let sound: Vec<u8> = little.as_chunks::<2>().0.iter().flat_map(|[low, high]| [*high, *low]).collect();
    form(b"AIFF", 16, &[], &sound)
}

/// AIFF (or AIFF-C, whose format ends with `packing`) of two channels of so many bits.
fn form(kind: &[u8; 4], bits: u16, packing: &[u8], sound: &[u8]) -> Vec<u8> {
    let frames = (sound.len() / usize::from(bits / 4)) as u32;
    let mut common = vec![0, 2];
    common.extend(frames.to_be_bytes());
    common.extend(bits.to_be_bytes());
    // The rate as 80 bits.
    let rate = 44_100_u64;
    let exponent = 63 - rate.leading_zeros();
    common.extend((16_383 + exponent as u16).to_be_bytes());
    common.extend((rate << (63 - exponent)).to_be_bytes());
    common.extend(packing);
    let piece = |name: &[u8], body: &[u8]| [name, &(body.len() as u32).to_be_bytes(), body].concat();
    let body =
        [kind.to_vec(), piece(b"COMM", &common), piece(b"SSND", &[vec![0; 8], sound.to_vec()].concat())];
    piece(b"FORM", &body.concat())
}

/// AIFF-C of a packing: its four letters, and a name of no letters.
fn aiff_c(packing: &[u8; 4], bits: u16, sound: &[u8]) -> Vec<u8> {
    form(b"AIFC", bits, &[packing.as_slice(), &[0, 0]].concat(), sound)
}

#[test]
fn aiff_c_of_any_byte_order_is_the_same_sound() {
    assert_same("sowt", &aiff_c(b"sowt", 16, &pcm16()));
    let big = |x: i16| x.to_be_bytes().to_vec();
    assert_same("NONE", &aiff_c(b"NONE", 16, &data(big)));
    let float = |x: i16| (f32::from(x) / 32_768.0).to_be_bytes().to_vec();
    assert_same("fl32", &aiff_c(b"fl32", 32, &data(float)));
    let double = |x: i16| (f64::from(x) / 32_768.0).to_be_bytes().to_vec();
    assert_same("fl64", &aiff_c(b"fl64", 64, &data(double)));
}

/// Every code of ITU-T G.711, from WAV and from AIFF-C, which two decoders read.
#[test]
fn recordings_of_telephones_are_the_same_in_wav_and_aiff_c() {
    let codes: Vec<u8> = (0..=255).flat_map(|code| [0x55, code]).collect();
    for (name, packing, tag, known) in [
        ("a-law", b"alaw", 6, [(0xd5, 8), (0x55, -8), (0xaa, 32_256), (0x2a, -32_256)]),
        ("u-law", b"ulaw", 7, [(0xff, 0), (0x7f, 0), (0x80, 32_124), (0x00, -32_124)]),
    ] {
        let wav = riff(b"RIFF", &[chunk(b"fmt ", &format(tag, 8, 2)), chunk(b"data", &codes)]);
        let wav = read(name, &wav).unwrap().samples;
        let aiff = read(name, &aiff_c(packing, 8, &codes)).unwrap().samples;
        assert_eq!((wav.len(), &wav), (256, &aiff), "{name}");
        for (code, value) in known {
            assert_eq!(wav[code], f64::from(value) / 32_768.0, "{name} {code:#x}");
        }
    }
}

#[test]
fn tags_of_players_in_front_and_behind_change_nothing() {
    let wav = riff(b"RIFF", &[chunk(b"fmt ", &format(1, 16, 4)), chunk(b"data", &pcm16())]);
    let old = [b"TAG".to_vec(), vec![b'x'; 125]].concat();
    assert_same("aiff", &aiff());
    for (name, bytes) in [("wav", wav), ("flac", flac()), ("aiff", aiff())] {
        for (version, size) in [(3, 55), (4, 70_000)] {
            let file = [tag(version, size), bytes.clone(), old.clone()].concat();
            assert_same(&format!("{name} {version}"), &file);
        }
        assert_same(&format!("{name} behind"), &[bytes, tag(4, 300)].concat());
    }
}

/// Reported as "unexpected end of file": a tagger writes its tag as a chunk into AIFF.
#[test]
fn an_aiff_with_a_tag_as_its_last_chunk_is_read_whole() {
    let (mut file, tag) = (aiff(), tag(3, 30));
    file.extend([b"ID3 ".as_slice(), &(tag.len() as u32).to_be_bytes(), &tag].concat());
    let size = (file.len() as u32 - 8).to_be_bytes();
    file[4..8].copy_from_slice(&size);
    assert_same("tagged aiff", &file);
}

#[test]
fn a_frame_size_of_0_is_that_of_the_samples() {
    let mut unsaid = format(1, 16, 4);
    unsaid[12..14].fill(0);
    assert_same("align", &riff(b"RIFF", &[chunk(b"fmt ", &unsaid), chunk(b"data", &pcm16())]));
}
