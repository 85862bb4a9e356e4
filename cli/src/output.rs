//! Files that appear complete, together, or not at all, and never over an input; and the one JSON
//! object on stdout.
//!
//! A verb hands over what it reads ([`reads`]); whatever is written afterwards is compared with it,
//! as the file system does: through links, hard links and detours of a path.
//!
//! Every file is written beside its final name under a temporary one. [`Outputs::commit`] gives all
//! of them their names at the end of the verb; an error or a panic before that leaves nothing
//! behind.

use crate::error::CliError;
use asperity_surface::image_io::save_gray16;
use asperity_surface::picture::{ImageError, Problem};
use asperity_surface::raster::Raster;
use std::cell::RefCell;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

thread_local! {
    /// Files that the verb of this thread reads.
    static READ: RefCell<Vec<PathBuf>> = const { RefCell::new(Vec::new()) };
}

/// Notes files that are read: none of them is written over. Names that are no file are passed over.
pub fn reads<P: Into<PathBuf>>(paths: impl IntoIterator<Item = P>) {
    let files = paths.into_iter().map(Into::into).filter(|path| path.is_file());
    READ.with_borrow_mut(|read| read.extend(files));
}

/// Clears the list of files that are read: for a verb that reads what it wrote itself and writes it
/// anew, or writes back what it was asked to change.
pub fn clear_reads() {
    READ.with_borrow_mut(Vec::clear);
}

/// Refuses a path to write that is a file which is read, before any work is done for it.
///
/// # Errors
/// When it is one, by whatever path.
pub fn refuse_input(path: &Path) -> Result<(), CliError> {
    if !path.is_file() {
        return Ok(());
    }
    let same = |read: &&PathBuf| same_file::is_same_file(path, read).unwrap_or(false);
    READ.with_borrow(|read| match read.iter().find(same) {
        None => Ok(()),
        Some(read) => {
            let what = if read == path {
                "is read as well".to_owned()
            } else {
                format!("is {}, which is read", read.display())
            };
            Err(CliError::file(path, what, "write somewhere else: an input is never written over"))
        }
    })
}

/// The files of one verb.
#[derive(Debug, Default)]
pub struct Outputs {
    pending: Vec<Pending>,
}

#[derive(Debug)]
struct Pending {
    temporary: PathBuf,
    path: PathBuf,
}

impl Outputs {
    /// No file yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Opens a file that will be called `path` after [`Self::commit`].
    ///
    /// # Errors
    /// When the folder is missing or cannot be written, or `path` is a folder or a file that is
    /// read.
    pub fn create(&mut self, path: &Path) -> Result<BufWriter<File>, CliError> {
        check_destination(path)?;
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let temporary = path.with_file_name(format!(".{name}.{}.part", std::process::id()));
        let file = File::create(&temporary).map_err(|error| CliError::write(path, &error))?;
        self.pending.push(Pending { temporary, path: path.to_owned() });
        Ok(BufWriter::with_capacity(1 << 18, file))
    }

    /// Writes a value as a JSON file.
    ///
    /// # Errors
    /// As [`Self::create`], or when the value is none of JSON's.
    pub fn write_json(&mut self, path: &Path, value: &impl serde::Serialize) -> Result<(), CliError> {
        let text = serde_json::to_string_pretty(value)
            .map_err(|error| CliError::file(path, error, "please report it with the input"))?;
        self.write(path, text.as_bytes())
    }

    /// Writes a whole file.
    ///
    /// # Errors
    /// As [`Self::create`], or when the disk is full.
    pub fn write(&mut self, path: &Path, bytes: &[u8]) -> Result<(), CliError> {
        self.write_with(path, |file| file.write_all(bytes))
    }

    /// Writes a file by a function.
    ///
    /// # Errors
    /// As [`Self::create`], or when the disk is full.
    pub fn write_with(
        &mut self,
        path: &Path,
        fill: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>,
    ) -> Result<(), CliError> {
        let mut file = self.create(path)?;
        fill(&mut file).and_then(|()| file.flush()).map_err(|error| CliError::write(path, &error))
    }

    /// Writes heights from 0 to 1 as a 16-bit grey PNG.
    ///
    /// # Errors
    /// As [`Self::write`], or when the heights are no picture.
    pub fn write_gray16(&mut self, path: &Path, heights: &Raster) -> Result<(), CliError> {
        drop(self.create(path)?);
        let temporary = self.pending.last().map_or(path, |pending| pending.temporary.as_path());
        save_gray16(temporary, heights).map_err(|error| match error.problem {
            Problem::Io(error) => CliError::write(path, &error),
            problem => CliError::from_error(ImageError { file: path.to_owned(), problem }),
        })
    }

    /// Gives every file its name.
    ///
    /// # Errors
    /// When a file cannot be renamed; then the files renamed before it are removed again.
    pub fn commit(mut self) -> Result<Vec<PathBuf>, CliError> {
        for pending in &self.pending {
            check_destination(&pending.path)?;
        }
        let mut done: Vec<PathBuf> = Vec::new();
        for pending in std::mem::take(&mut self.pending) {
            if let Err(error) = fs::rename(&pending.temporary, &pending.path) {
                let _ = fs::remove_file(&pending.temporary);
                for path in done {
                    let _ = fs::remove_file(path);
                }
                return Err(CliError::write(&pending.path, &error));
            }
            done.push(pending.path);
        }
        Ok(done)
    }
}

impl Drop for Outputs {
    fn drop(&mut self) {
        for pending in &self.pending {
            let _ = fs::remove_file(&pending.temporary);
        }
    }
}

/// Refuses a path that cannot become a file, before any work is done for it.
///
/// # Errors
/// When the path has no file name, is a folder or a file that is read, or lies in a folder that
/// does not exist.
pub fn check_destination(path: &Path) -> Result<(), CliError> {
    if path.file_name().is_none() {
        return Err(CliError::file(path, "is not a file name", "name the file to write"));
    }
    if path.is_dir() {
        return Err(CliError::file(path, "is a folder", "name the file to write"));
    }
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() && !folder.is_dir() => Err(CliError::file(
            path,
            format!("the folder {} does not exist", folder.display()),
            "create it, or write somewhere else",
        )),
        _ => refuse_input(path),
    }
}

/// Makes sure that a folder exists, for the verbs that fill one.
///
/// # Errors
/// When it cannot be made, or a file has its name.
pub fn ensure_folder(path: &Path) -> Result<(), CliError> {
    if path.exists() && !path.is_dir() {
        return Err(CliError::file(path, "is a file", "name a folder"));
    }
    fs::create_dir_all(path).map_err(|error| CliError::write(path, &error))
}

/// `STEM` + `.suffix`, keeping whatever dots the stem has.
#[must_use]
pub fn with_suffix(stem: &Path, suffix: &str) -> PathBuf {
    let mut name = stem.as_os_str().to_owned();
    name.push(".");
    name.push(suffix);
    PathBuf::from(name)
}

/// A path as a shell takes it: in quotes where it holds more than letters and marks.
pub fn quoted(path: &Path) -> String {
    let path = path.display().to_string();
    let is_plain = path.chars().all(|c| c.is_alphanumeric() || "-_./\\:+=,@".contains(c));
    if is_plain { path } else { format!("\"{path}\"") }
}

/// Writes text to stdout; a closed pipe is the reader's choice, not an error.
pub fn say(text: &str) {
    let _ = print(text);
}

fn print(text: &str) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "{text}").and_then(|()| out.flush())
}

/// Warnings as lines that follow a text.
#[must_use]
pub fn warned(warnings: &[String]) -> String {
    warnings.iter().map(|warning| format!("\nwarning: {warning}")).collect()
}

/// Files in a row.
#[must_use]
pub fn listed(files: &[PathBuf]) -> String {
    files.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ")
}

/// Prints a report: as one JSON object, or in words.
///
/// # Errors
/// As [`say_json`].
pub fn say_report(
    report: &impl serde::Serialize,
    as_json: bool,
    in_words: impl FnOnce() -> String,
) -> Result<(), CliError> {
    if as_json {
        return say_json(report);
    }
    say(&in_words());
    Ok(())
}

/// Prints one JSON object to stdout.
///
/// # Errors
/// When the value cannot be written as JSON, or there is no room for it.
pub fn say_json(value: &impl serde::Serialize) -> Result<(), CliError> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|error| CliError::new("--json", error, "please report it with the input"))?;
    match print(&text) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(CliError::write(Path::new("stdout"), &error))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_left_behind_when_the_verb_fails() {
        let folder = tempfile::tempdir().unwrap();
        let mut outputs = Outputs::new();
        outputs.write(&folder.path().join("a.txt"), b"half").unwrap();
        drop(outputs);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn files_get_their_names_together() {
        let folder = tempfile::tempdir().unwrap();
        let mut outputs = Outputs::new();
        outputs.write(&folder.path().join("a"), b"1").unwrap();
        outputs.write(&folder.path().join("b"), b"2").unwrap();
        assert!(!folder.path().join("a").exists());
        assert_eq!(outputs.commit().unwrap().len(), 2);
        assert_eq!(fs::read(folder.path().join("b")).unwrap(), b"2");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[cfg(unix)]
    #[test]
    fn an_input_is_refused_as_an_output_by_whatever_path() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("in.wav"), b"sound").unwrap();
        fs::write(at("other.wav"), b"sound").unwrap();
        std::os::unix::fs::symlink(at("in.wav"), at("link.wav")).unwrap();
        fs::hard_link(at("in.wav"), at("hard.wav")).unwrap();
        reads([at("in.wav"), at("missing.wav")]);
        for name in ["in.wav", "./in.wav", "../x/in.wav", "link.wav", "hard.wav"] {
            let name = name.replace('x', &folder.path().file_name().unwrap().to_string_lossy());
            let refused = Outputs::new().create(&at(&name)).unwrap_err().to_string();
            assert!(refused.contains("which is read") || refused.contains("is read as well"), "{refused}");
            assert!(refused.contains("; write somewhere else"), "{refused}");
        }
        for name in ["other.wav", "missing.wav", "new.wav"] {
            Outputs::new().create(&at(name)).unwrap();
        }
        assert_eq!(fs::read(at("in.wav")).unwrap(), b"sound");
    }

    #[test]
    fn a_missing_folder_is_named_before_work_begins() {
        let error = check_destination(Path::new("nowhere/at/all/x.wav")).unwrap_err().to_string();
        assert!(error.contains("nowhere/at/all does not exist"), "{error}");
    }

    #[test]
    fn a_suffix_keeps_the_dots_of_the_stem() {
        assert_eq!(with_suffix(Path::new("out/v1.2"), "audio.wav"), Path::new("out/v1.2.audio.wav"));
    }
}
