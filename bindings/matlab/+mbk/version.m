function text = version()
% mbk.version  The version of mbk: '1.0.0'.
  text = mbk_mex('version');
end
