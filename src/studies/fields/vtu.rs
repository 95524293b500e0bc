//! Points with numbers as VTK's XML has them: a grid of vertices, arrays in base64 behind their lengths.

use std::io::{self, Write};

use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;

/// Numbers of one kind, with their bytes from the least on.
pub trait Number: Copy {
    /// What VTK calls the kind.
    const KIND: &'static str;
    /// The bytes, behind each other.
    fn put(self, out: &mut dyn Write) -> io::Result<()>;
}

macro_rules! number {
    ($($own:ty: $kind:literal),*) => {$(
        impl Number for $own {
            const KIND: &'static str = $kind;
            fn put(self, out: &mut dyn Write) -> io::Result<()> {
                out.write_all(&self.to_le_bytes())
            }
        }
    )*};
}

number!(f64: "Float64", i32: "Int32", i64: "Int64", u8: "UInt8");

/// A file that is being written.
pub struct Grid<W: Write> {
    out: W,
}

impl<W: Write> Grid<W> {
    /// Begins a file of so many points, whose columns are written next.
    pub fn begin(mut out: W, points: usize) -> io::Result<Self> {
        writeln!(out, "<?xml version=\"1.0\"?>")?;
        writeln!(
            out,
            "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">"
        )?;
        writeln!(
            out,
            "<UnstructuredGrid>\n<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{points}\">\n<PointData>"
        )?;
        Ok(Grid { out })
    }

    /// A column: a name of the program's own, and a number for each point.
    pub fn column<N: Number>(&mut self, name: &str, numbers: impl ExactSizeIterator<Item = N>) -> io::Result<()> {
        self.array(&format!("Name=\"{name}\""), numbers)
    }

    /// Ends the file with the places of the points.
    pub fn end(mut self, places: &[[f64; 3]]) -> io::Result<()> {
        writeln!(self.out, "</PointData>\n<CellData>\n</CellData>\n<Points>")?;
        let numbers = places.as_flattened().iter().copied();
        self.array("Name=\"Points\" NumberOfComponents=\"3\"", numbers)?;
        writeln!(self.out, "</Points>\n<Cells>")?;
        let count = places.len();
        self.column("connectivity", (0..count).map(|k| k as i64))?;
        self.column("offsets", (0..count).map(|k| k as i64 + 1))?;
        self.column("types", (0..count).map(|_| 1u8))?;
        writeln!(self.out, "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>")?;
        self.out.flush()
    }

    fn array<N: Number>(&mut self, named: &str, numbers: impl ExactSizeIterator<Item = N>) -> io::Result<()> {
        write!(self.out, "<DataArray type=\"{}\" {named} format=\"binary\">", N::KIND)?;
        let mut coded = EncoderWriter::new(&mut self.out, &STANDARD);
        coded.write_all(&((numbers.len() * size_of::<N>()) as u64).to_le_bytes())?;
        for number in numbers {
            number.put(&mut coded)?;
        }
        coded.finish()?;
        drop(coded);
        writeln!(self.out, "</DataArray>")
    }
}
