//! Thinning: reduces the points of a curve to those needed for a picture, with all extremes.

/// A point in the units of the axes; a coordinate that is not finite interrupts the curve.
pub type Point = (f64, f64);

/// Points kept of each bucket: smallest and largest x and y.
const KEPT: usize = 4;

/// At most about `most` of the points, in their order. Of each run of neighbours those with the
/// smallest and the largest x and y are kept; a run without any finite point leaves a gap.
pub fn thin(points: &[Point], most: usize) -> Vec<Point> {
    if points.len() <= most.max(KEPT) {
        return points.to_vec();
    }
    let buckets = (most / KEPT).max(1);
    points.chunks(points.len().div_ceil(buckets)).flat_map(extremes).collect()
}

/// The outline of the area between two curves over the same rising `places`, at about `most` places: along
/// the upper curve and back along the lower. Neighbours are replaced by their envelope, so no part of the
/// area is lost.
pub fn outline(places: &[f64], low: &[f64], high: &[f64], most: usize) -> Vec<Point> {
    let size = places.len().div_ceil(most.max(1)).max(1);
    let least = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = |values: &[f64]| values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let places: Vec<f64> =
        places.chunks(size).map(|chunk| 0.5 * (chunk[0] + chunk[chunk.len() - 1])).collect();
    let upper = places.iter().copied().zip(high.chunks(size).map(most));
    let lower: Vec<Point> = places.iter().copied().zip(low.chunks(size).map(least)).collect();
    upper.chain(lower.into_iter().rev()).collect()
}

/// The points of a bucket that its picture needs.
fn extremes(bucket: &[Point]) -> Vec<Point> {
    let finite = || (0..bucket.len()).filter(|&i| is_drawable(bucket[i]));
    let x = |a: &usize, b: &usize| bucket[*a].0.total_cmp(&bucket[*b].0);
    let y = |a: &usize, b: &usize| bucket[*a].1.total_cmp(&bucket[*b].1);
    let kept = [finite().min_by(x), finite().max_by(x), finite().min_by(y), finite().max_by(y)];
    let mut kept: Vec<usize> = kept.into_iter().flatten().collect();
    kept.sort_unstable();
    kept.dedup();
    if kept.is_empty() { vec![(f64::NAN, f64::NAN)] } else { kept.into_iter().map(|i| bucket[i]).collect() }
}

/// Stretches drawn of a path that is too long to be drawn whole.
const STRETCHES: usize = 12;

/// Share of a column's range that a path must move by to be drawn on.
const VISIBLE: f64 = 0.0025;

/// Rows to draw of a path through several columns, at most about `most`, in order: those at which a column
/// has changed visibly. If these are still too many, sections of neighbouring rows from the whole path, each
/// followed by `None`, a gap. Each section has the true shape.
pub fn thin_path(columns: &[&[f64]], most: usize) -> Vec<Option<usize>> {
    let rows = columns.iter().map(|column| column.len()).min().unwrap_or(0);
    if rows <= most {
        return (0..rows).map(Some).collect();
    }
    let kept = visible_rows(columns, rows);
    if kept.len() <= most {
        return kept.into_iter().map(Some).collect();
    }
    let length = (most / STRETCHES).max(2).min(kept.len());
    let start = |stretch: usize| stretch * (kept.len() - length) / (STRETCHES - 1);
    let stretch =
        |number| kept[start(number)..start(number) + length].iter().copied().map(Some).chain([None]);
    (0..STRETCHES).flat_map(stretch).collect()
}

/// The rows at which some column has moved visibly since the row before them here.
fn visible_rows(columns: &[&[f64]], rows: usize) -> Vec<usize> {
    let step = |column: &&[f64]| {
        let finite = column.iter().copied().filter(|v| v.is_finite());
        let (low, high) = finite.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
        VISIBLE * (high - low)
    };
    let steps: Vec<f64> = columns.iter().map(step).collect();
    let mut kept = vec![0];
    for row in 1..rows {
        let last = kept[kept.len() - 1];
        let moved = columns.iter().zip(&steps).any(|(column, &step)| {
            let (before, now) = (column[last], column[row]);
            (now - before).abs() > step || now.is_finite() != before.is_finite()
        });
        if moved || row + 1 == rows {
            kept.push(row);
        }
    }
    kept
}

/// True if both coordinates are numbers.
pub fn is_drawable(point: Point) -> bool {
    point.0.is_finite() && point.1.is_finite()
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::sin;

    use super::*;

    #[test]
    fn extremes_and_order_are_kept() {
        let wave = |k: usize| (k as f64, sin(0.001 * k as f64) + f64::from(u8::from(k == 70_123)) * 9.0);
        let points: Vec<Point> = (0..100_000).map(wave).collect();
        let thinned = thin(&points, 2000);
        assert!(thinned.len() <= 2000 && thinned.len() > 500, "{}", thinned.len());
        assert!(thinned.windows(2).all(|pair| pair[0].0 < pair[1].0), "out of order");
        assert!(thinned.contains(&points[70_123]));
        assert_eq!((thinned[0], thinned[thinned.len() - 1]), (points[0], points[99_999]));
        let lowest = |points: &[Point]| points.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
        assert_eq!(lowest(&thinned), lowest(&points));
    }

    #[test]
    fn few_points_stay_as_they_are_and_blanks_leave_gaps() {
        let few = [(0.0, 1.0), (1.0, f64::NAN)];
        assert_eq!(thin(&few, 100).len(), 2);
        let blank = |k: usize| (k as f64, if (300..700).contains(&k) { f64::NAN } else { 1.0 });
        let points: Vec<Point> = (0..1000).map(blank).collect();
        let thinned = thin(&points, 80);
        let gaps = thinned.windows(2).filter(|pair| is_drawable(pair[0]) && !is_drawable(pair[1])).count();
        assert_eq!(gaps, 1);
        assert!(thin(&[], 10).is_empty());
    }

    #[test]
    fn an_outline_goes_round_everything() {
        let places: Vec<f64> = (0..7).map(f64::from).collect();
        let low: Vec<f64> = places.iter().map(|t| -t).collect();
        let high: Vec<f64> = places.iter().map(|t| (t - 2.0).abs()).collect();
        let exact = outline(&places, &low, &high, 100);
        assert_eq!(
            (exact.len(), exact[0], exact[6], exact[7], exact[13]),
            (14, (0.0, 2.0), (6.0, 4.0), (6.0, -6.0), (0.0, 0.0))
        );
        let coarse = outline(&places, &low, &high, 3);
        assert_eq!(coarse, [(1.0, 2.0), (4.0, 3.0), (6.0, 4.0), (6.0, -6.0), (4.0, -5.0), (1.0, -2.0)]);
        assert!(outline(&[], &[], &[], 10).is_empty());
    }

    #[test]
    fn a_long_path_keeps_the_shape_of_its_loops() {
        let rows = 300_000;
        let wave = |cycles: f64, shift: f64| -> Vec<f64> {
            (0..rows).map(|k| sin(std::f64::consts::TAU * cycles * k as f64 / rows as f64 + shift)).collect()
        };
        for (cycles, most) in [(2.0, 3000), (2000.0, 3000)] {
            let (x, y) = (wave(cycles, 0.0), wave(cycles, 1.0));
            let path = thin_path(&[&x, &y], most);
            assert!(path.len() <= most + STRETCHES, "{}", path.len());
            assert!(path.iter().flatten().is_sorted());
            for pair in path.windows(2) {
                let [Some(a), Some(b)] = *pair else { continue };
                assert!((x[a] - x[b]).abs().max((y[a] - y[b]).abs()) < 0.08, "{cycles}: a chord of the loop");
            }
        }
        let constant = vec![1.0; rows];
        assert_eq!(thin_path(&[&constant], 100), [Some(0), Some(rows - 1)]);
    }
}
