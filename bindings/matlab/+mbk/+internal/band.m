function band(x, low, high, light)
% Fills the area between two lines where both are finite. Draw lines after it, so that they are on top.
  x = x(:)';
  low = low(:)';
  high = high(:)';
  there = isfinite(low) & isfinite(high);
  if any(there)
    fill([x(there), fliplr(x(there))], [low(there), fliplr(high(there))], light, 'EdgeColor', 'none');
    hold on
  end
end
