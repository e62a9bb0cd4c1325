//! A serialised state: a head that says what the bytes are, then the state, compressed.
//!
//! head: 8 bytes that name us, format number (u32), CRC-32 of all that follows (u32), length of the GUID (u16), the
//! GUID; numbers little-endian. The CRC finds every change of up to 32 bits in a row, and every truncation with odds of
//! 2³² to 1.

use thiserror::Error;

const MAGIC: &[u8; 8] = b"swidstat";

/// Number of the format; it goes up whenever states of an earlier build can no longer be read.
pub const FORMAT: u32 = 2;

/// Why bytes are no state of this FMU.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SealError {
    /// They begin otherwise, or are shorter than the head.
    #[error("the bytes are none that fmi2SerializeFMUstate of such an FMU wrote")]
    Unknown,
    /// They are of another version of the FMU.
    #[error(
        "the bytes have format {found}, this FMU reads format {FORMAT}: save the state with this version of the FMU"
    )]
    Format {
        /// Number of their format.
        found: u32,
    },
    /// They were changed or cut off.
    #[error("the checksum is wrong: the bytes were changed or cut off since they were written")]
    Checksum,
    /// They belong to another FMU.
    #[error("it belongs to the FMU with GUID {found}")]
    Foreign {
        /// The other FMU's GUID.
        found: String,
    },
    /// The state itself cannot be read.
    #[error("its content cannot be read ({why})")]
    Content {
        /// What the reader says.
        why: String,
    },
}

/// The head for a state of the FMU with that GUID; its checksum is still to be written by [`seal`].
pub fn head(guid: &str) -> Vec<u8> {
    let length = guid.len().min(usize::from(u16::MAX));
    let mut bytes = Vec::from(*MAGIC);
    bytes.extend(FORMAT.to_le_bytes());
    bytes.extend(0_u32.to_le_bytes());
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(&guid.as_bytes()[..length]);
    bytes
}

/// Writes the checksum into bytes that begin with a [`head`].
pub fn seal(bytes: &mut [u8]) {
    if let Some((start, rest)) = bytes.split_at_mut_checked(16) {
        start[12..].copy_from_slice(&crc32fast::hash(rest).to_le_bytes());
    }
}

/// The state behind the head, after every check.
///
/// # Errors
/// [`SealError`].
pub fn open<'a>(bytes: &'a [u8], guid: &str) -> Result<&'a [u8], SealError> {
    let (magic, rest) = bytes.split_first_chunk::<8>().ok_or(SealError::Unknown)?;
    if magic != MAGIC {
        return Err(SealError::Unknown);
    }
    let (format, rest) = rest.split_first_chunk::<4>().ok_or(SealError::Checksum)?;
    let found = u32::from_le_bytes(*format);
    if found != FORMAT {
        return Err(SealError::Format { found });
    }
    let (checksum, rest) = rest.split_first_chunk::<4>().ok_or(SealError::Checksum)?;
    if crc32fast::hash(rest) != u32::from_le_bytes(*checksum) {
        return Err(SealError::Checksum);
    }
    let (length, rest) = rest.split_first_chunk::<2>().ok_or(SealError::Checksum)?;
    let (owner, state) = rest.split_at_checked(u16::from_le_bytes(*length).into()).ok_or(SealError::Checksum)?;
    if owner != guid.as_bytes() {
        return Err(SealError::Foreign { found: String::from_utf8_lossy(owner).into_owned() });
    }
    Ok(state)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sealed() -> Vec<u8> {
        let mut bytes = head("a-guid");
        bytes.extend([1, 2, 3, 250]);
        seal(&mut bytes);
        bytes
    }

    #[test]
    fn what_was_sealed_opens() {
        assert_eq!(open(&sealed(), "a-guid"), Ok(&[1, 2, 3, 250][..]));
    }

    #[test]
    fn every_flipped_bit_and_every_lost_byte_is_seen() {
        let whole = sealed();
        for bit in 0..8 * whole.len() {
            let mut bytes = whole.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            assert!(open(&bytes, "a-guid").is_err(), "bit {bit}");
        }
        for length in 0..whole.len() {
            assert!(open(&whole[..length], "a-guid").is_err(), "{length} bytes");
        }
    }

    #[test]
    fn another_version_and_another_fmu_are_named() {
        let mut bytes = sealed();
        bytes[8] = 7;
        assert_eq!(open(&bytes, "a-guid"), Err(SealError::Format { found: 7 }));
        assert_eq!(open(&sealed(), "b"), Err(SealError::Foreign { found: "a-guid".into() }));
    }
}
