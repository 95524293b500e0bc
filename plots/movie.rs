//! Pictures one after the other as a moving PNG, which browsers and viewers play and all others show the first picture of.

use std::fs::File;
use std::io::{BufReader, Write};
use std::path::{Path, PathBuf};

use crate::PlotError;

/// Time of a picture (ms).
const EACH_MS: u16 = 100;

/// Time of the last picture (ms), before it starts again.
const LAST_MS: u16 = 2000;

/// Writes the pictures as one file, whose size is that of the first.
///
/// # Errors
/// Where a picture cannot be read, has another size or kind of pixels than the first, or the file cannot be written.
pub fn movie(pictures: &[PathBuf], out: &mut dyn Write) -> Result<(), PlotError> {
    let Some(first) = pictures.first() else { return Ok(()) };
    let (size, _) = picture(first)?;
    let failed = |error: png::EncodingError| PlotError::Encode(error.into());
    let mut encoder = png::Encoder::new(out, size.0, size.1);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_animated(pictures.len() as u32, 0).map_err(failed)?;
    encoder.set_frame_delay(EACH_MS, 1000).map_err(failed)?;
    let mut writer = encoder.write_header().map_err(failed)?;
    for (k, path) in pictures.iter().enumerate() {
        let (own, pixels) = picture(path)?;
        if own != size {
            return Err(PlotError::Encode(
                format!("{}: {own:?} pixels, the first has {size:?}", path.display()).into(),
            ));
        }
        if k + 1 == pictures.len() {
            writer.set_frame_delay(LAST_MS, 1000).map_err(failed)?;
        }
        writer.write_image_data(&pixels).map_err(failed)?;
    }
    writer.finish().map_err(failed)
}

/// Width and height of a picture, and its pixels in three bytes each.
fn picture(path: &Path) -> Result<((u32, u32), Vec<u8>), PlotError> {
    let unread = |error: &dyn std::fmt::Display| PlotError::Encode(format!("{}: {error}", path.display()).into());
    let file = File::open(path).map_err(|error| unread(&error))?;
    let mut reader = png::Decoder::new(BufReader::new(file)).read_info().map_err(|error| unread(&error))?;
    let size = reader.output_buffer_size().ok_or_else(|| unread(&"too large"))?;
    let mut pixels = vec![0; size];
    let info = reader.next_frame(&mut pixels).map_err(|error| unread(&error))?;
    if (info.color_type, info.bit_depth) != (png::ColorType::Rgb, png::BitDepth::Eight) {
        return Err(unread(&"not three bytes a pixel"));
    }
    pixels.truncate(info.buffer_size());
    Ok(((info.width, info.height), pixels))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canvas::Canvas;

    #[test]
    fn a_movie_shows_its_pictures_one_after_the_other() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut paths = Vec::new();
        for k in 0..3 {
            let mut canvas = Canvas::new(60.0, 40.0, "t");
            let left = 10.0 * f64::from(k);
            canvas.rectangle((left, 0.0), (left + 10.0, 40.0), crate::style::BLUE);
            paths.push(folder.path().join(format!("{k}.png")));
            std::fs::write(&paths[k as usize], canvas.png().expect("drawn")).expect("written");
        }
        let mut whole = Vec::new();
        movie(&paths, &mut whole).expect("a movie");
        let mut reader = png::Decoder::new(std::io::Cursor::new(&whole)).read_info().expect("a picture");
        let control = *reader.info().animation_control().expect("it moves");
        assert_eq!((control.num_frames, control.num_plays), (3, 0));
        for path in &paths {
            let mut pixels = vec![0; reader.output_buffer_size().expect("small")];
            reader.next_frame(&mut pixels).expect("a frame");
            assert_eq!(pixels, picture(path).expect("a picture").1);
        }
        std::fs::write(&paths[1], Canvas::new(50.0, 40.0, "t").png().expect("drawn")).expect("written");
        assert!(movie(&paths, &mut Vec::new()).is_err(), "another size");
    }
}
