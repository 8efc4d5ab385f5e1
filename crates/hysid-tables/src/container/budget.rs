//! Limits on the unpacked size of a file: a small one may claim any size, and compression gives a thousandfold.

use std::cell::Cell;
use std::io::{self, Cursor, Read};
use std::rc::Rc;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use zip::ZipArchive;

/// Bytes that any file may unpack to.
const FREE_BYTES: u64 = 8 << 20;

/// Bytes that come out of a byte. Tables of measured numbers are packed five to thirty times.
const BYTES_PER_BYTE: u64 = 50;

/// Numbers that any file may have.
const FREE_NUMBERS: u64 = 1 << 20;

/// Time for any file, and for a megabyte.
const FREE_TIME: Duration = Duration::from_secs(10);
const TIME_PER_MEGABYTE: Duration = Duration::from_secs(2);

/// Message on a file whose content violates its format.
pub const DAMAGED: &str = "it is damaged or cut off";

/// Name of the threads that run libraries. What panics there is an error of the file.
pub const THREAD: &str = "hysid-container";

/// Bytes and cells that a file may unpack to, by its length.
#[derive(Debug, Clone, Copy)]
pub struct Budget {
    length: u64,
}

impl Budget {
    /// Budget of a file with `length` bytes.
    pub fn of(length: usize) -> Self {
        Self { length: length as u64 }
    }

    /// Most bytes that it unpacks to.
    pub fn bytes(self) -> u64 {
        FREE_BYTES.saturating_add(BYTES_PER_BYTE.saturating_mul(self.length))
    }

    /// Most cells of a spreadsheet, the empty ones between others too.
    pub fn cells(self) -> u64 {
        FREE_NUMBERS.saturating_add(2 * self.length)
    }

    /// Most numbers of a binary file, which stores each in a byte or more and may be packed.
    pub fn numbers(self) -> u64 {
        FREE_NUMBERS.saturating_add(8 * self.length)
    }

    fn time(self) -> Duration {
        FREE_TIME + TIME_PER_MEGABYTE * u32::try_from(self.length >> 20).unwrap_or(u32::MAX / 1000)
    }

    pub fn unpacked(self, reader: impl Read) -> Result<Vec<u8>, String> {
        let mut bytes = Vec::new();
        let most = self.bytes();
        reader.take(most + 1).read_to_end(&mut bytes).map_err(|_| DAMAGED)?;
        if bytes.len() as u64 > most {
            return Err(too_much());
        }
        Ok(bytes)
    }

    /// The parts of an archive whose names are wanted, at most `most` and together within the budget.
    ///
    /// # Errors
    /// No archive, a damaged one, more parts, and those of `is_wanted`.
    pub fn parts(
        self,
        archive: &[u8],
        most: usize,
        is_wanted: impl Fn(&str) -> Result<bool, String>,
    ) -> Result<Vec<(String, Vec<u8>)>, String> {
        let mut archive = ZipArchive::new(Cursor::new(archive)).map_err(|_| DAMAGED)?;
        if archive.len() > most {
            return Err(format!("it has more than {most} parts"));
        }
        let (mut parts, mut left) = (Vec::new(), self.bytes());
        for place in 0..archive.len() {
            let part = archive.by_index(place).map_err(|_| DAMAGED)?;
            let name = part.name().map_err(|_| DAMAGED)?.into_owned();
            if !is_wanted(&name)? {
                continue;
            }
            let content = self.unpacked(part)?;
            left = left.checked_sub(content.len() as u64).ok_or_else(too_much)?;
            parts.push((name, content));
        }
        Ok(parts)
    }

    /// Runs a library, which may panic or never end.
    ///
    /// # Errors
    /// Those of the library, a panic, and more time than the budget.
    pub fn run<T: Send + 'static, E: From<String> + Send + 'static>(
        self,
        read: impl FnOnce() -> Result<T, E> + Send + 'static,
    ) -> Result<T, E> {
        let (sender, receiver) = mpsc::channel();
        let work = move || drop(sender.send(read()));
        let started = thread::Builder::new().name(THREAD.into()).spawn(work);
        started.map_err(|error| format!("no thread: {error}"))?;
        match receiver.recv_timeout(self.time()) {
            Ok(result) => result,
            Err(mpsc::RecvTimeoutError::Disconnected) => Err("it is damaged".to_string().into()),
            Err(mpsc::RecvTimeoutError::Timeout) => {
                Err(format!("it takes more than {} s, as damaged files do", self.time().as_secs()).into())
            }
        }
    }
}

/// Message on a file that unpacks to more than its budget.
pub fn too_much() -> String {
    format!(
        "it unpacks to more than {BYTES_PER_BYTE} times its size, and {} MB are free: unpack it beforehand, or save it as CSV",
        FREE_BYTES >> 20
    )
}

/// Counts the bytes that a reader gives.
pub struct CountingReader {
    reader: Box<dyn Read>,
    count: Rc<Cell<u64>>,
}

/// A reader that unpacks, within the budget of what was read so far.
pub struct UnpackingReader<R> {
    reader: R,
    packed: Rc<Cell<u64>>,
    unpacked: u64,
}

impl<R: Read> UnpackingReader<R> {
    /// `unpack` makes the reader that unpacks.
    pub fn of(packed: Box<dyn Read>, unpack: impl FnOnce(CountingReader) -> R) -> Self {
        let count = Rc::new(Cell::new(0));
        let reader = unpack(CountingReader { reader: packed, count: Rc::clone(&count) });
        Self { reader, packed: count, unpacked: 0 }
    }
}

impl Read for CountingReader {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.reader.read(buffer)?;
        self.count.set(self.count.get() + read as u64);
        Ok(read)
    }
}

impl<R: Read> Read for UnpackingReader<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.reader.read(buffer)?;
        self.unpacked += read as u64;
        let budget = Budget { length: self.packed.get() };
        if self.unpacked > budget.bytes() {
            return Err(io::Error::other(too_much()));
        }
        Ok(read)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panics_and_loops_of_libraries_are_errors() {
        let budget = Budget::of(100);
        assert_eq!(budget.run::<_, String>(|| Ok(3)), Ok(3));
        assert_eq!(budget.run::<(), String>(|| panic!("capacity overflow")), Err("it is damaged".into()));
    }

    #[test]
    fn unpacking_ends_at_the_budget() {
        let most = Budget::of(0).bytes() as usize;
        assert_eq!(Budget::of(0).unpacked(io::repeat(0).take(most as u64)).unwrap().len(), most);
        assert!(Budget::of(0).unpacked(io::repeat(0)).unwrap_err().contains("50 times"));
        let mut endless = UnpackingReader::of(Box::new(io::empty()), |_| io::repeat(7));
        let error = io::copy(&mut endless, &mut io::sink()).unwrap_err();
        assert!(error.to_string().contains("50 times"), "{error}");
    }
}
