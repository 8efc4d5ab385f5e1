//! A Functional Mock-up Unit for co-simulation: the C code with the functions of the standard around it.

mod binary;
mod description;
mod self_test;
mod wrapper;

use std::io::{Cursor, Write as _};

use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use crate::error::Error;
use crate::manifest::checksum;
use crate::options::FmiVersion;
use crate::reserved;
use crate::subject::{ExportFile, ExportSubject};
use crate::target::template::filled;
use crate::target::{BackEnd, TargetFiles, c};
use crate::text::in_markdown;

pub(super) const BACK_END: BackEnd = BackEnd {
    name: "fmu",
    has_single_precision: false,
    has_inverse: true,
    reserved: &[reserved::C, reserved::FMU],
    write,
    usage,
};

fn write(subject: &ExportSubject<'_>) -> Result<TargetFiles, Error> {
    let (name, version) = (subject.name(), subject.fmi());
    let mut sources = c::sources(subject);
    // Files that differ have tokens that differ.
    let token = checksum(&sources.iter().flat_map(|file| file.content.clone()).collect::<Vec<_>>());
    sources.push(ExportFile::new(version.source(), wrapper::wrapper(subject, version, &token)));
    let binary = binary::binary(name, version, &sources)?;
    let note = match binary {
        Some(_) => None,
        None => Some(format!(
            "{name}.fmu has source code only, because there is no C compiler here (cc, gcc or clang; the environment \
             variable CC names another)"
        )),
    };
    let mut content = vec![ExportFile::new(
        "modelDescription.xml",
        description::model_description(subject, version, &token),
    )];
    content.extend(binary);
    if version == FmiVersion::Three {
        content
            .push(ExportFile::new("sources/buildDescription.xml", description::build_description(subject)));
    }
    content.extend(
        sources.into_iter().map(|file| ExportFile::new(format!("sources/{}", file.path), file.content)),
    );
    let archive = zipped(&content).map_err(|error| Error::Archive(error.to_string()))?;
    let test = match subject.inverse() {
        None => self_test::self_test(subject),
        Some(inverse) => self_test::of_inverse(subject, inverse),
    };
    let files = vec![
        ExportFile::new(format!("{name}.fmu"), archive),
        ExportFile::new(format!("{name}_test.py"), test),
    ];
    Ok(TargetFiles { files, note })
}

/// An archive of files. It has no dates, so that the same model gives the same archive.
fn zipped(files: &[ExportFile]) -> zip::result::ZipResult<Vec<u8>> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default()
        .compression_method(zip::CompressionMethod::Stored)
        .last_modified_time(zip::DateTime::default());
    for file in files {
        archive.start_file(file.path.as_str(), options)?;
        archive.write_all(&file.content)?;
    }
    Ok(archive.finish()?.into_inner())
}

fn usage(subject: &ExportSubject<'_>) -> String {
    let name = subject.name();
    let (inputs, outputs) = description::variable_names(subject);
    let listed = |names: &[String]| names.iter().map(|name| in_markdown(name)).collect::<Vec<_>>().join(", ");
    let (what, more) = match subject.inverse() {
        None => (
            "a unit",
            "The directional derivative is that of the output by the first input.",
        ),
        Some(_) => (
            "the inverse of the model as a unit",
            "It has no directional derivative.

`reach` is 0 where the model has the wanted output. It is 1 beyond the output of the lowest input, 2 beyond that of the
highest input, 3 where the input cannot change so quickly, 4 where the model is not monotone, 5 where its output jumps
over the wanted one, and -1 after an invalid time step. The limits are in `{name}_inverse.h` among the sources.",
        ),
    };
    let more = more.replace("{name}", name);
    filled(
        include_str!("fmu/usage.md.txt"),
        &[
            ("NAME", name),
            ("@what@", what),
            ("@version@", subject.fmi().number()),
            ("@inputs@", &listed(&inputs)),
            ("@outputs@", &listed(&outputs)),
            ("@more@", &more),
        ],
    )
}
